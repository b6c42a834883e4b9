//! One program for the tables and figures of the thesis, and for the questions that it left open.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin reproduce
//! cargo run --release -p sidc-studies --bin reproduce -- --quick --out target/reproduction
//! ```
//!
//! Writes docs/reproduction: README.md, a CSV file per table, an SVG file per figure. Seeds are fixed, so the same machine writes the same files; another may
//! differ in the last digits of near-zero numbers.

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use sidc_studies::reproduce::{CHAPTERS, Chapter, Effort};

#[derive(Parser)]
struct Args {
    /// Few draws, for a look: less than a minute. Give another --out, or the committed figures are replaced
    #[arg(long)]
    quick: bool,
    /// Where to write
    #[arg(long, default_value = "docs/reproduction")]
    out: PathBuf,
    /// Only these sections; README.md then has no others
    #[arg(long, num_args = 1..)]
    only: Vec<String>,
}

const HEAD: &str = include_str!("head.md");

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let effort = if args.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let chosen = chosen(&args.only)?;
    fs::create_dir_all(&args.out)?;
    let start = Instant::now();
    let mut contents = String::new();
    let mut body = String::new();
    for chapter in chosen {
        let begun = Instant::now();
        eprintln!("{}", chapter.title);
        let section =
            (chapter.write)(effort).map_err(|fault| format!("{}: {fault}", chapter.name))?;
        for file in &section.files {
            fs::write(args.out.join(&file.name), &file.content)?;
        }
        contents += &format!("- [{}](#{})\n", chapter.title, anchor(chapter.title));
        body += &format!("## {}\n\n{}\n", chapter.title, section.text);
        eprintln!(
            "  {:.1} s, {:.0} s in all",
            begun.elapsed().as_secs_f64(),
            start.elapsed().as_secs_f64()
        );
    }
    fs::write(
        args.out.join("README.md"),
        format!("{HEAD}\n{contents}\n{}\n", body.trim_end()),
    )?;
    Ok(())
}

fn chosen(only: &[String]) -> Result<Vec<&'static Chapter>, String> {
    let known = |name: &String| CHAPTERS.iter().any(|c| c.name == *name);
    if let Some(name) = only.iter().find(|n| !known(n)) {
        let names: Vec<&str> = CHAPTERS.iter().map(|c| c.name).collect();
        return Err(format!(
            "no section is named {name}; there are {}",
            names.join(", ")
        ));
    }
    let wanted = |c: &&Chapter| only.is_empty() || only.iter().any(|n| n == c.name);
    Ok(CHAPTERS.iter().filter(wanted).collect())
}

/// The anchor of a heading in links.
fn anchor(title: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let low = title.to_lowercase();
    low.chars()
        .filter(kept)
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}
