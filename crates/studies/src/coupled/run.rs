//! Trials of a system: every law, from several numbers of rows, in several gradings.
//!
//! In: a family, a swing, a seed, and what to try. Out: trials, grouped by problem, in the order of the gradings.

use sidc_discover::split;
use sidc_testing::plants::coupled::{Coupled, Family, Law, Point, Swing};

use super::dictionary::Tabulated;
use super::grading::Grading;
use super::library::{Library, Size};
use super::trial::{Outcome, outcome};

/// Rows of a record, and seconds between them.
const ROWS: usize = 800;
const STEP: f64 = 0.05;
/// Libraries with more atoms are skipped; this many make 1,594,323 terms.
const MOST_ATOMS: usize = 13;

#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub family: Family,
    pub swing: Swing,
    pub seed: u64,
}

#[derive(Clone, Debug)]
pub struct Plan {
    pub rows: Vec<usize>,
    pub sizes: Vec<Size>,
    pub gradings: Vec<Grading>,
    /// Number of steps after which a path is abandoned.
    pub steps: usize,
}

pub struct Trial {
    /// The law's coordinate, and its number of terms.
    pub law: usize,
    pub true_terms: usize,
    pub atoms: usize,
    pub rows: usize,
    pub grading: Grading,
    pub outcome: Outcome,
}

pub fn cases(families: &[Family], seeds: std::ops::Range<u64>) -> Vec<Case> {
    let of = |seed| {
        families.iter().flat_map(move |family| {
            [Swing::Large, Swing::Small].map(|swing| Case {
                family: *family,
                swing,
                seed,
            })
        })
    };
    seeds.flat_map(of).collect()
}

/// One law, one library, rows of one record.
pub struct RegressionCase<'a> {
    pub system: &'a Coupled,
    pub law: &'a Law,
    pub library: &'a Library,
    /// Time in seconds, and the measured point.
    pub rows: Vec<&'a (f64, Point)>,
}

/// Trials of every grading for every problem.
pub fn trials(case: &Case, plan: &Plan) -> Vec<Trial> {
    let tried = |posed: &RegressionCase| {
        let points: Vec<&Point> = posed.rows.iter().map(|(_, p)| p).collect();
        let target = points.iter().map(|p| p.accelerations[posed.law.coordinate]);
        let target: Vec<f64> = target.collect();
        let tabulated = Tabulated::new(&posed.library.atoms, &points);
        let Some(phi) = tabulated.dictionary() else {
            return Vec::new();
        };
        let trial = |grading: &Grading| {
            let grades = tabulated.grades(grading);
            let (law, library) = (posed.law, posed.library);
            Trial {
                law: law.coordinate,
                true_terms: law.terms.len(),
                atoms: library.atoms.len(),
                rows: posed.rows.len(),
                grading: *grading,
                outcome: outcome((&phi, &grades), &target, law, library, plan.steps),
            }
        };
        plan.gradings.iter().map(trial).collect()
    };
    let made: Vec<Vec<Trial>> = problems(case, plan, tried);
    made.into_iter().flatten().collect()
}

/// Applies `work` to every problem of a case.
pub fn problems<A>(case: &Case, plan: &Plan, mut work: impl FnMut(&RegressionCase) -> A) -> Vec<A> {
    let system = Coupled::draw(case.family, case.seed);
    let record = system.record(case.swing, ROWS, STEP);
    let mut made = Vec::new();
    for law in system.laws() {
        let mut done = Vec::new();
        for size in &plan.sizes {
            let library = Library::new(&system, &law, *size, case.seed);
            let atoms = library.atoms.len();
            // A law may have more atoms than requested.
            if done.contains(&atoms) || atoms > MOST_ATOMS {
                continue;
            }
            done.push(atoms);
            for rows in &plan.rows {
                let picked = split(record.len(), 1, Some(*rows), case.seed).used;
                made.push(work(&RegressionCase {
                    system: &system,
                    law: &law,
                    library: &library,
                    rows: picked.iter().map(|r| &record[*r]).collect(),
                }));
            }
        }
    }
    made
}
