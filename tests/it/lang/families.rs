//! Families of equations mean the same as their equations written by hand.

use proptest::prelude::*;

use super::functions::meaning;
use super::{model, said};

#[test]
fn a_family_is_its_equations() {
    let with = "state x1..x4\ninput u\ndx[i] ~ <x[i-1]*x[i+1], x[i], u>, i = 1..4 cyclic\n";
    let each = [(1, 4, 2), (2, 1, 3), (3, 2, 4), (4, 3, 1)];
    let each = each.map(|(i, before, after)| format!("dx{i} ~ <x{before}*x{after}, x{i}, u>\n"));
    let plain = format!("state x1..x4\ninput u\n{}", each.concat());
    assert_eq!(meaning(with), meaning(&plain));
    let written: Vec<String> = model(with)
        .equations
        .into_iter()
        .map(|e| e.written)
        .collect();
    let lines: Vec<&str> = plain.lines().skip(2).collect();
    assert_eq!(written, lines);
}

#[test]
fn an_index_alone_is_a_number() {
    let with = "state q1..q3 : order 2\nlet n = 3\nlet f(a, b) = sin(a/b)\nddq[k] ~ required(q[k]) + poly(q[k], q'[k]; k) + f(q[k], k), k = 1..n\n";
    let each = (1..4)
        .map(|k| format!("ddq{k} ~ required(q{k}) + poly(q{k}, dq{k}; {k}) + sin(q{k}/{k})\n"));
    let plain = format!("state q1..q3 : order 2\n{}", each.collect::<String>());
    assert_eq!(meaning(with), meaning(&plain));
    let known = "state x01..x12\ndx[j] = -j*x[j], j = 9..10\n";
    assert_eq!(
        meaning(known),
        meaning("state x01..x12\ndx09 = -9*x09\ndx10 = -10*x10\n")
    );
}

#[test]
fn what_is_said_of_coefficients_has_families() {
    let laws = "state x1..x4\ninput u\ndx[i] ~ <x[i-1], x[i], u>, i = 1..4 cyclic\n";
    let with = format!(
        "{laws}constrain coef(dx[i], x[i]) < 0, i = 2..3\nconstrain -1 < coef(dx[i], x[i]) <= 2*coef(dx[i+1], x[i+1]), i = 1..2\n"
    );
    let plain = format!(
        "{laws}constrain coef(dx2, x2) < 0\nconstrain coef(dx3, x3) < 0\n\
         constrain -1 < coef(dx1, x1) <= 2*coef(dx2, x2)\nconstrain -1 < coef(dx2, x2) <= 2*coef(dx3, x3)\n"
    );
    let rows = |text: &str| -> Vec<String> {
        let constraints = model(text).constraints.into_iter();
        let row = constraints.map(|c| {
            let of = c.coefficients.iter();
            let of: Vec<_> = of.map(|k| (k.weight, k.target, k.term.clone())).collect();
            format!("{of:?} {:?} {}", c.relation, c.constant)
        });
        row.collect()
    };
    assert_eq!(rows(&with), rows(&plain));
    let runs = model(&format!("{laws}coef(dx[i], u) : per run, i = 1..3\n"));
    assert_eq!(runs.per_run.len(), 3);
}

#[test]
fn samples_keep_their_brackets_elsewhere() {
    assert!(said("state x\nx[k+1] ~ <x[k]>\n").contains("foreign-spelling"));
    let both = "state x1..x2, i\ndx[k] ~ <x[k], i>, k = 1..2\n";
    assert!(!said(both).contains("error"), "{}", said(both));
    // An error in a family is reported once.
    let wrong = said("state x1..x9\ndx[k] ~ <x[k], w>, k = 1..9\n");
    assert_eq!(wrong.matches("error[").count(), 1, "{wrong}");
}

#[test]
fn a_family_has_a_size() {
    let text =
        |n: usize| format!("state x1..x{n}\ndx[i] ~ poly(x[i], x[i+1]; 2), i = 1..{n} cyclic\n");
    assert_eq!(model(&text(500)).equations.len(), 500);
    let terms: Vec<String> = (0..3000).map(|k| format!("x[i]*{k}")).collect();
    let large = format!(
        "state x1..x9000\ndx[i] ~ <{}>, i = 1..9000\n",
        terms.join(", ")
    );
    assert!(said(&large).contains("error[too-large]"));
    assert!(said("state x1..x3\ndx[i] ~ <x[i]>, i = 1..99999999\n").contains("error[index]"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// A ring with neighbours at any distance.
    #[test]
    fn a_ring_closes(n in 2usize..9, back in 0usize..12, on in 0usize..12) {
        let with = format!("state x1..x{n}\ndx[i] ~ <x[i - {back}]^2, x[i+{on}], sin(x[i])>, i = 1..{n} cyclic\n");
        let mut plain = format!("state x1..x{n}\n");
        for i in 0..n {
            let place = |k: usize| k % n + 1;
            let before = place(i + 12 * n - back);
            plain += &format!("dx{} ~ <x{before}^2, x{}, sin(x{})>\n", i + 1, place(i + on), i + 1);
        }
        prop_assert_eq!(meaning(&with), meaning(&plain));
    }
}
