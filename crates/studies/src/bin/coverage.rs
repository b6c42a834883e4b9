//! Do 95 % intervals contain the truth in 95 % of draws? Compares coefficients ± 1.96 standard errors with known laws.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin coverage -- [CASE…] [--level 0.01 0.05] [--draws 200] [--terms]
//! ```
//!
//! The motion of a case is fixed, its noise is drawn each time, and the whole program runs on it. Prints a row per case from the draws with the true
//! supports, then the marks of all terms found in all draws.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use sidc_studies::coverage::case::Case;
use sidc_studies::coverage::figures::Row;
use sidc_studies::coverage::{
    accelerometer, driven, figures, filtered, odebench, pendulum, run, sampled_input,
};

/// Measures how often 95 % intervals hold the truth.
#[derive(Parser, Debug)]
struct Args {
    /// Cases whose name starts so; all if none is given
    case: Vec<String>,
    /// Noise over the size of each signal
    #[arg(long, num_args = 1.., default_values_t = [0.01, 0.05])]
    level: Vec<f64>,
    /// Draws of noise at each level
    #[arg(long, default_value_t = 200)]
    draws: u64,
    /// Show every term
    #[arg(long)]
    terms: bool,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let wanted = |c: &Case| args.case.is_empty() || args.case.iter().any(|w| c.name.starts_with(w));
    let cases: Vec<Case> = all().into_iter().filter(wanted).collect();
    for level in &args.level {
        println!(
            "{} % noise, {} draws\n{}",
            100.0 * level,
            args.draws,
            figures::HEAD
        );
        let (mut sum, mut marks) = ((0, 0), run::Marked::default());
        for case in &cases {
            let start = Instant::now();
            let draws = match run::draws(case, *level, args.draws) {
                Ok(draws) => draws,
                Err(said) => {
                    eprintln!("{}: {said}", case.name);
                    return ExitCode::FAILURE;
                }
            };
            let row = Row::new(case, &draws);
            println!(
                "{}  {:.2} s",
                row.text(),
                start.elapsed().as_secs_f64() / draws.len().max(1) as f64
            );
            if args.terms {
                println!("{}", row.terms_text());
            }
            let (covered, all) = row.covered();
            sum = (sum.0 + covered, sum.1 + all);
            figures::add(&mut marks, &row.marks);
        }
        println!(
            "all terms of all cases: {:.1} %",
            100.0 * sum.0 as f64 / f64::from(sum.1.max(1))
        );
        for (name, [own, other]) in ["doubtful", "likely", "firm"].iter().zip(marks) {
            println!("marked {name}: {own} terms of the laws, {other} others");
        }
        println!();
    }
    ExitCode::SUCCESS
}

fn all() -> Vec<Case> {
    let mut all = pendulum::cases();
    all.extend(odebench::cases());
    all.push(odebench::short());
    all.extend(accelerometer::cases());
    all.extend(sampled_input::cases());
    all.extend(driven::cases());
    all.extend(filtered::cases());
    all
}
