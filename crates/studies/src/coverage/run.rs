//! Runs a case through the whole program with many draws of noise, and collects each true coefficient with its standard error.
//!
//! In: a case, a level, a number of draws. Out: a [`Draw`] each, in the order of the seeds. Makes the same calls as `sidc identify`.

use sidc::pipeline;
use sidc::{Options, Unwatched};
use sidc_data::{Limits, read};
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::Discovery;

use super::case::Case;

/// The result of one draw of noise.
pub struct Draw {
    /// Coefficient and standard error of every true term, law by law; `None` unless all supports are true.
    pub exact: Option<Vec<(f64, f64)>>,
    pub marks: Marked,
}

/// Numbers of terms found by mark (doubtful, likely, firm): terms of the laws, and others.
pub type Marked = [[usize; 2]; 3];

/// Number of draws that run concurrently.
const THREADS: u64 = 2;

/// # Errors
/// Diagnostics of a model or table that the program rejects.
pub fn draws(case: &Case, level: f64, count: u64) -> Result<Vec<Draw>, String> {
    let share = |first: u64| {
        let seeds = (first..count).step_by(THREADS as usize);
        seeds
            .map(|seed| draw(case, level, seed))
            .collect::<Vec<_>>()
    };
    let mut shares: Vec<_> = std::thread::scope(|scope| {
        let spawn = |first| scope.spawn(move || share(first));
        let running: Vec<_> = (0..THREADS).map(spawn).collect();
        running
            .into_iter()
            .filter_map(|r| r.join().ok())
            .map(Vec::into_iter)
            .collect()
    });
    let threads = shares.len().max(1) as u64;
    (0..count)
        .filter_map(|seed| shares.get_mut((seed % threads) as usize)?.next())
        .collect()
}

fn draw(case: &Case, level: f64, seed: u64) -> Result<Draw, String> {
    let found = identify(case, level, seed)?;
    Ok(Draw {
        exact: compared(case, &found),
        marks: marked(case, &found),
    })
}

fn identify(case: &Case, level: f64, seed: u64) -> Result<Discovery, String> {
    let mut sources = Sources::default();
    let file = sources.add("coverage.sid", case.model.as_str());
    let (program, said) = pipeline::compile(file, &sources, pipeline::MEMORY);
    let program = program.ok_or_else(|| render(&said, &sources, false))?;
    let mut tables = Vec::new();
    for (i, text) in case.noisy(level, seed).iter().enumerate() {
        let table = read(
            &format!("{i}.csv"),
            text.as_bytes(),
            &Limits::default(),
            &mut sources,
        );
        tables.push(table.map_err(|d| render(&d, &sources, false))?);
    }
    let (data, options) = (
        pipeline::from_tables(tables, Vec::new()),
        Options::default(),
    );
    let staged = pipeline::measure(&program, &data, &options, &mut sources, &mut Unwatched);
    let measured = staged.0.ok_or_else(|| render(&staged.1, &sources, false))?;
    let found = pipeline::identify(&program, &measured, &options, &mut Unwatched);
    found.map_err(|d| render(&d, &sources, false))
}

fn marked(case: &Case, found: &Discovery) -> Marked {
    let mut marks = Marked::default();
    for e in &found.equations {
        let target = found.name(e.target);
        let law = case.laws.iter().find(|(t, _)| *t == target);
        for t in &e.terms {
            let name = Language(found).term(&t.term);
            let own = law.is_some_and(|(_, terms)| terms.iter().any(|(n, _)| *n == name));
            if let Some(trust) = &t.evidence {
                marks[trust.mark as usize][usize::from(!own)] += 1;
            }
        }
    }
    marks
}

fn compared(case: &Case, found: &Discovery) -> Option<Vec<(f64, f64)>> {
    let mut all = Vec::new();
    for (target, truth) in &case.laws {
        let equation = found
            .equations
            .iter()
            .find(|e| found.name(e.target) == *target)?;
        if equation.terms.len() != truth.len() {
            return None;
        }
        for (name, _) in truth {
            let same =
                |t: &&sidc_system::discovery::FoundTerm| Language(found).term(&t.term) == *name;
            let term = equation.terms.iter().find(same)?;
            all.push((term.coefficient, term.standard_error?));
        }
    }
    Some(all)
}
