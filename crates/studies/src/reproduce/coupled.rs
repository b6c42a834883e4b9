//! Random coupled mechanisms: rows needed for their laws, with plain and with graded norms.

use super::tidy::{Tidy, percent};
use super::{Effort, Fault, Section, work};
use crate::coupled::{Case, Outcome, Plan, Size, Trial, cases, degree, identified, trials};
use sidc_testing::plants::coupled::{FAMILIES, Swing};

/// Choices of norms, as indices into the gradings of [`plan`]; an empty list means those of `sidc identify`.
const CHOICES: [(&str, &[usize]); 3] =
    [("plain", &[0]), ("by degree", &[0, 1, 2]), ("as sidc", &[])];
/// The share of exact answers that is required.
const WANTED: f64 = 0.95;
/// Number of samples at which shares are reported in addition.
const BESIDE: usize = 60;

fn plan(effort: Effort) -> Plan {
    Plan {
        rows: effort.of(vec![20, 40, 60, 120, 200], vec![30]),
        sizes: vec![Size::Atoms(effort.of(10, 8))],
        gradings: [1.0, 1.2, 1.5].map(degree).to_vec(),
        steps: effort.of(600, 200),
    }
}

/// Number of exact answers for a family, swing and choice at each number of rows; and the number of problems.
struct Count {
    exact: Vec<usize>,
    of: usize,
}

/// Answers to the problems of a case.
struct Found {
    /// Grouped by problem.
    trials: Vec<Trial>,
    /// One per problem.
    identified: Vec<Outcome>,
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let plan = plan(effort);
    let families = effort.of(&FAMILIES[..], &FAMILIES[8..]);
    let seeds = effort.of(4, 1);
    let cases = cases(families, 40..40 + seeds);
    let found = work::all("coupled", &cases, |case| {
        Ok(Found {
            trials: trials(case, &plan),
            identified: identified(case, &plan)?,
        })
    })?;
    let mut csv = Tidy::new(&["system", "swing", "norms", "samples", "draws", "exact"]);
    let mut table = Tidy::new(&["system", "swing", "laws", "plain", "by degree", "as sidc"]);
    let mut sums = Tidy::new(&["swing", "norms", "exact at each number of samples"]);
    for swing in [Swing::Large, Swing::Small] {
        let swung = if swing == Swing::Large {
            "large"
        } else {
            "small"
        };
        for family in families {
            let counts = CHOICES.map(|(_, members)| {
                count(&plan, &cases, &found, members, |c| {
                    c.family == *family && c.swing == swing
                })
            });
            for ((norms, _), c) in CHOICES.iter().zip(&counts) {
                for (m, k) in plan.rows.iter().zip(&c.exact) {
                    csv.push([
                        family.name().into(),
                        swung.into(),
                        (*norms).into(),
                        m.to_string(),
                        c.of.to_string(),
                        k.to_string(),
                    ]);
                }
            }
            let [plain, by_degree, as_sidc] = counts.each_ref().map(|c| c.needed(&plan.rows));
            let laws = counts[0].of.to_string();
            table.push([
                family.name().into(),
                swung.into(),
                laws,
                plain,
                by_degree,
                as_sidc,
            ]);
        }
        for (norms, members) in CHOICES {
            let c = count(&plan, &cases, &found, members, |c| c.swing == swing);
            let share = |(m, k): (&usize, &usize)| {
                format!("{m}: {}", percent(*k as f64 / c.of.max(1) as f64))
            };
            let shares: Vec<String> = plan.rows.iter().zip(&c.exact).map(share).collect();
            sums.push([swung.into(), norms.into(), shares.join(", ")]);
        }
    }
    let text = format!(
        "{}\n{}\nMechanisms with random masses, lengths, springs and frictions, two to four coordinates; each law is asked for by its own acceleration, out of `powers(…; 2)` of ten atoms \
         (59,049 terms or more): those of the law, the others at random. In large swings every angle goes beyond 2.5 rad, in small ones none beyond 0.6 rad. The cells of the first table are the fewest samples from which on {:.0} % of the laws are exact, and how many laws are exact from {BESIDE}. *By degree* solves in the plain norm and with weights κ^degree, κ = 1.2 and 1.5, *as sidc* is what [`sidc identify` tries](../method.md#graded-norms). A path in the plain norm or by degree is given up after {} steps.\n",
        table.markdown(),
        sums.markdown(),
        100.0 * WANTED,
        plan.steps,
    );
    Ok(Section {
        text,
        files: vec![csv.csv("coupled.csv")],
    })
}

fn count(
    plan: &Plan,
    cases: &[Case],
    found: &[Found],
    members: &[usize],
    keep: impl Fn(&Case) -> bool,
) -> Count {
    let (mut exact, mut of) = (vec![0; plan.rows.len()], 0);
    let kept = cases.iter().zip(found).filter(|(case, _)| keep(case));
    for (_, found) in kept {
        let problems = found.trials.chunks(plan.gradings.len());
        for (trials, identified) in problems.zip(&found.identified) {
            let answers = members.iter().filter_map(|k| trials.get(*k));
            let order = |o: &&Outcome| (!o.solved, o.terms);
            let best = answers.map(|t| &t.outcome).min_by_key(order);
            let rows = trials.first().map(|t| t.rows);
            let Some(place) = plan.rows.iter().position(|m| Some(*m) == rows) else {
                continue;
            };
            exact[place] += usize::from(best.unwrap_or(identified).exact);
            of += usize::from(place == 0);
        }
    }
    Count { exact, of }
}

impl Count {
    /// Fewest rows from which on enough answers are exact, and the number of exact answers at [`BESIDE`].
    fn needed(&self, rows: &[usize]) -> String {
        let enough = |k: &usize| *k as f64 >= WANTED * self.of as f64;
        let after = self.exact.iter().rposition(|k| !enough(k));
        let first = rows.get(after.map_or(0, |at| at + 1));
        let most = rows.last().copied().unwrap_or(0);
        let first = first.map_or(format!("> {most}"), usize::to_string);
        let at = rows.iter().position(|m| *m == BESIDE);
        match at.and_then(|at| self.exact.get(at)) {
            Some(exact) => format!("{first}; {exact}"),
            None => first,
        }
    }
}
