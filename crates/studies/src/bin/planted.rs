//! Sixty planted cases: is the cause named, and does any wrong answer pass?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin planted -- [NAME…] [--seed=N] [--show]
//! ```
//!
//! Prints a line per case and a table of causes; with `--show` also what the program says of each case.

use std::collections::BTreeMap;
use std::time::Instant;

use sidc_studies::planted::{cases, run};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let show = arguments.iter().any(|a| a == "--show");
    let seed = arguments
        .iter()
        .find_map(|a| a.strip_prefix("--seed=")?.parse().ok());
    let wanted: Vec<&String> = arguments.iter().filter(|a| !a.starts_with("--")).collect();
    let mut kinds: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    for case in cases::cases(seed.unwrap_or(0)) {
        if !wanted.is_empty() && !wanted.iter().any(|w| case.name.starts_with(w.as_str())) {
            continue;
        }
        let start = Instant::now();
        let outcome = run::run(&case);
        let seconds = start.elapsed().as_secs_f64();
        let row = kinds.entry(case.kind).or_default();
        row[0] += 1;
        match outcome {
            Ok(o) => {
                row[1] += usize::from(o.right_cause);
                row[2] += usize::from(o.right_answer);
                row[3] += usize::from(o.firm_and_wrong());
                let answer = match (o.right_answer, o.passes) {
                    (true, true) => "right, passes",
                    (true, false) => "right, doubted",
                    (false, false) => "wrong, doubted",
                    (false, true) => "WRONG, PASSES",
                };
                let mark = if o.right_cause { "  " } else { "✗ " };
                println!(
                    "{mark}{:18} {:17} {answer:15} {seconds:.2} s",
                    case.name, o.named
                );
                if show {
                    println!("{}\n{}", case.model, o.shown);
                }
            }
            Err(said) => println!("✗ {:18} no answer: {said}", case.name),
        }
    }
    println!("\ncause              cases  named  right answer  wrong and passing");
    let mut sum = [0; 4];
    for (kind, row) in &kinds {
        println!(
            "{kind:18} {:5}  {:5}  {:12}  {:17}",
            row[0], row[1], row[2], row[3]
        );
        sum.iter_mut().zip(row).for_each(|(s, r)| *s += r);
    }
    println!(
        "{:18} {:5}  {:5}  {:12}  {:17}",
        "all", sum[0], sum[1], sum[2], sum[3]
    );
}
