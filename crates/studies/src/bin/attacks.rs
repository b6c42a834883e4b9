//! Random attacks on the verdict: how often does a wrong law pass, and how often is a right one doubted?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin attacks -- [--seeds=N] [--show] [--write=FOLDER]
//! ```
//!
//! Prints a line for each kind of attack and level of noise. With `--show`, also each wrong pass and each right law that is doubted; with `--write`, writes
//! their models and tables.

use sidc::{Data, Discovery, Model, Options};
use sidc_testing::attacks::{Attack, Case, Law, case};

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let show = arguments.iter().any(|a| a == "--show");
    let seeds = arguments
        .iter()
        .find_map(|a| a.strip_prefix("--seeds=")?.parse().ok())
        .unwrap_or(20);
    let folder = arguments.iter().find_map(|a| a.strip_prefix("--write="));
    println!("attack         noise  right passes  right doubted  wrong doubted  WRONG PASSES");
    for attack in Attack::ALL {
        for noise in [0.0, 0.001, 0.01, 0.05] {
            let mut counts = [0; 4];
            for seed in 0..seeds {
                let case = case(attack, seed, noise);
                let Some(found) = identify(&case) else {
                    counts[2] += 1;
                    continue;
                };
                let outcome = outcome(&case, &found);
                counts[outcome] += 1;
                if outcome == 0 || outcome == 2 {
                    continue;
                }
                if show {
                    println!("  seed {seed}: {}", said(&found));
                }
                if let Some(folder) = folder {
                    let name = format!("{folder}/{attack:?}_{noise}_{seed}");
                    std::fs::write(format!("{name}.sid"), &case.model)?;
                    for (i, run) in case.runs.iter().enumerate() {
                        std::fs::write(format!("{name}_{i}.csv"), run.csv())?;
                    }
                }
            }
            let [a, b, c, d] = counts;
            let name = format!("{attack:?}");
            println!("{name:13} {noise:6}  {a:12}  {b:13}  {c:13}  {d:12}");
        }
    }
    Ok(())
}

fn identify(case: &Case) -> Option<Discovery> {
    let model = Model::parse(&case.model).ok()?;
    let mut data = Data::new();
    for run in case.columns() {
        data = data.run(run).ok()?;
    }
    model.identify(&data, &Options::default()).ok()
}

/// For the worst equation: 0 right and passes, 1 right and doubted, 2 wrong and doubted, 3 wrong and passes.
fn outcome(case: &Case, found: &Discovery) -> usize {
    case.laws
        .iter()
        .map(|law| judged(law, found))
        .max()
        .unwrap_or(2)
}

fn judged(law: &Law, found: &Discovery) -> usize {
    let Some(equation) = found.equations().iter().find(|e| e.target == law.target) else {
        return 2;
    };
    let mut terms: Vec<&str> = equation.terms.iter().map(|t| t.term.as_str()).collect();
    let mut truth: Vec<&str> = law.terms.iter().map(String::as_str).collect();
    terms.sort_unstable();
    truth.sort_unstable();
    let right = law.offered && terms == truth;
    let passes = equation.reasons.is_empty();
    match (right, passes) {
        (true, true) => 0,
        (true, false) => 1,
        (false, false) => 2,
        (false, true) => 3,
    }
}

fn said(found: &Discovery) -> String {
    let equation = |e: &sidc::Equation| {
        let terms: Vec<String> = (e.terms.iter())
            .map(|t| format!("{:.4}*{}", t.coefficient, t.term))
            .collect();
        let codes: Vec<&str> = e.reasons.iter().map(|r| r.code.as_str()).collect();
        format!("{} = {} {codes:?}", e.target, terms.join(" + "))
    };
    let all: Vec<String> = found.equations().iter().map(equation).collect();
    all.join("; ")
}
