//! One equation as a regression problem: a model's text and columns of numbers → Φ and y for a solver.
//!
//! For sweeps and studies, which have their data in memory and inspect solutions before a criterion selects terms. Estimates nothing, weights no rows, reads
//! no files.

use super::program::{self, Program, needed};
use sidc_data::{Column, Origin, Samples};
use sidc_discover::dictionary::{BadValue, compile, subtract};
use sidc_discover::{NormSearch, Proposal};
use sidc_lang::library::{Library, MEMORY, known_terms};
use sidc_lang::model::RightSide;
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_progress::Observer;
use sidc_solve::dictionary::Dictionary;
use sidc_solve::{Problem, SOLVERS};

/// One equation on its rows: y = Φ a.
pub struct Regression {
    /// Φ, M × N; its columns are the slots of the equation's library.
    pub dictionary: Box<dyn Dictionary>,
    /// The target without its `known(…)` parts, length M.
    pub target: Vec<f64>,
    samples: Samples,
}

impl Regression {
    /// Basis pursuit (ε = 0) or basis pursuit denoising with ε = `tolerance`, in the units of the target.
    pub fn problem(&self, tolerance: f64) -> Problem<'_> {
        Problem {
            dictionary: self.dictionary.as_ref(),
            target: &self.target,
            tolerance,
        }
    }

    /// Answers for the plain and the graded norms, searched for as in `sidc identify`, those with fewest terms first.
    pub fn proposals(
        &self,
        library: &Library,
        tolerance: f64,
        observer: &mut dyn Observer,
    ) -> Vec<Proposal> {
        let search = NormSearch {
            library,
            samples: &self.samples,
            problem: self.problem(tolerance),
            solver: SOLVERS[0],
        };
        search.proposals(&search.every_norm(), observer)
    }
}

impl Program {
    /// Compiles a model's text; messages call its file `name`.
    ///
    /// ```
    /// use sidc::pipeline::Program;
    ///
    /// let program = Program::compile("pendulum.sid", "state th : order 2\nddth ~ powers(th, dth, sin th; 2)\n")?;
    /// assert_eq!(program.library("ddth").map(|l| l.len()), Some(27));
    ///
    /// let wrong = Program::compile("pendulum.sid", "state th : order 2\nddth ~ powers(th, omega; 2)\n");
    /// assert!(wrong.is_err_and(|message| message.contains("omega")));
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// The diagnostics as the command line prints them, including warnings.
    pub fn compile(name: &str, text: &str) -> Result<Program, String> {
        let mut sources = Sources::default();
        let file = sources.add(name, text);
        let (program, found) = program::compile(file, &sources, MEMORY);
        program.ok_or_else(|| render(&found, &sources, false))
    }

    /// The library of an equation, by the name of its target; `None` if that equation is not searched for.
    pub fn library(&self, target: &str) -> Option<&Library> {
        let at = self.place(target)?;
        self.libraries.get(at)?.as_ref()
    }

    /// Rows of every signal that the equations mention, from named columns; other columns are ignored. All values count as measured, with the noise that the
    /// model declares.
    ///
    /// ```
    /// # use sidc::pipeline::Program;
    /// let program = Program::compile("fall.sid", "state v, x\ndv ~ <1, v, v*abs(v)>\n")?;
    /// let (v, dv) = ([0.0, 1.0, 2.0], [-9.8, -9.7, -9.6]);
    /// let samples = program.samples(&[0.0, 0.1, 0.2], &[("v", &v), ("dv", &dv)])?;
    /// assert_eq!((samples.len(), samples.columns.len()), (3, 2));
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// A signal without a column, a column whose length differs from `time`, a value that is not finite.
    pub fn samples(&self, time: &[f64], columns: &[(&str, &[f64])]) -> Result<Samples, String> {
        let signals = needed(self);
        let columns: Result<Vec<Column>, String> = signals
            .into_iter()
            .map(|signal| self.column(signal, time.len(), columns))
            .collect();
        Ok(Samples {
            trajectory: vec![0; time.len()],
            time: time.to_vec(),
            columns: columns?,
        })
    }

    fn column(
        &self,
        signal: Signal,
        rows: usize,
        columns: &[(&str, &[f64])],
    ) -> Result<Column, String> {
        let name = self.model.name(signal);
        let given = columns.iter().find(|(n, _)| *n == name);
        let (_, values) = given.ok_or_else(|| format!("no column is named {name}"))?;
        if values.len() != rows {
            let length = values.len();
            return Err(format!("column {name} has {length} values for {rows} rows"));
        }
        if let Some(row) = values.iter().position(|v| !v.is_finite()) {
            return Err(format!(
                "column {name} is {} in row {row}, counted from 0",
                values[row]
            ));
        }
        Ok(Column {
            signal,
            values: values.to_vec(),
            origin: Origin::Measured {
                noise: self.model.noise(signal),
            },
        })
    }

    /// Φ and y of one equation on the given rows.
    ///
    /// ```
    /// use sidc::pipeline::Program;
    /// use sidc_progress::Unwatched;
    /// use sidc_solve::{SOLVERS, certify};
    ///
    /// // A ball falls through air: 0.05 v|v| of drag, found out of ten terms on six rows.
    /// let program = Program::compile("fall.sid", "state v\ndv ~ <1, v*abs(v)> * powers(v; 4)\n")?;
    /// let v = [-0.5, -3.0, -6.0, 1.0, -9.0, 4.0];
    /// let dv = v.map(|v| -9.8 - 0.05 * v * f64::abs(v));
    /// let samples = program.samples(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5], &[("v", &v), ("dv", &dv)])?;
    ///
    /// let regression = program.regression("dv", &samples)?;
    /// let problem = regression.problem(0.0);
    /// let solution = SOLVERS[0].solve(&problem, &mut Unwatched);
    /// let found = program.terms("dv", &solution.coefficients);
    /// assert_eq!(found[0].0, "1");
    /// assert_eq!(found[1].0, "v*abs(v)");
    /// assert!((found[0].1 + 9.8).abs() < 1e-9 && (found[1].1 + 0.05).abs() < 1e-9);
    ///
    /// // The proof asks the data, not the solver.
    /// let certificate = certify(&problem, &solution.coefficients, &solution.dual);
    /// assert!(certificate.proves_unique);
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// No such equation, or one without a library; a target missing from the samples; a term without a finite value.
    pub fn regression(&self, target: &str, samples: &Samples) -> Result<Regression, String> {
        let library = self.library(target);
        let library = library.ok_or_else(|| format!("no terms are looked for in {target}"))?;
        let equation = self
            .place(target)
            .and_then(|at| self.model.equations.get(at));
        let equation = equation.ok_or_else(|| format!("there is no equation of {target}"))?;
        let measured = samples.column(equation.target);
        let mut y = match measured {
            Some(column) => column.values.clone(),
            None => return Err(format!("no column is named {target}")),
        };
        if let RightSide::Search { known, .. } = &equation.right {
            let known = known_terms(known.iter().map(|(e, _)| e));
            subtract(&mut y, known.iter().map(|(a, t)| (*a, t)), samples);
        }
        let dictionary = compile(library, samples, None).map_err(|bad| self.undefined(&bad))?;
        Ok(Regression {
            dictionary,
            target: y,
            samples: samples.clone(),
        })
    }

    fn undefined(&self, bad: &BadValue) -> String {
        let term = Language(&self.model).term(&bad.term);
        format!(
            "{term} has no finite value in row {}, counted from 0",
            bad.row
        )
    }

    /// The terms of (column, coefficient) pairs, spelled as they are printed; columns without a term are skipped.
    pub fn terms(&self, target: &str, coefficients: &[(usize, f64)]) -> Vec<(String, f64)> {
        let Some(library) = self.library(target) else {
            return Vec::new();
        };
        let named = |(slot, a): &(usize, f64)| {
            let term = library
                .term(*slot)
                .filter(|_| !library.is_empty_slot(*slot));
            term.map(|t| (Language(&self.model).term(&t), *a))
        };
        coefficients.iter().filter_map(named).collect()
    }

    /// The columns of terms, spelled as they are printed except for the order of factors; `None` if a term is not in the library. Only products of terms
    /// whose factors occur in the spelling are compared.
    ///
    /// ```
    /// # use sidc::pipeline::Program;
    /// let program = Program::compile("pendulum.sid", "state th : order 2\nddth ~ powers(th, dth, sin th; 2)\n")?;
    /// let slots = program.slots("ddth", &["sin(th)*dth^2", "cos(th)"]);
    /// assert!(slots[0].is_some() && slots[1].is_none());
    /// # Ok::<(), String>(())
    /// ```
    pub fn slots(&self, target: &str, terms: &[&str]) -> Vec<Option<usize>> {
        let slot = |library, term: &&str| self.slot(library, term);
        match self.library(target) {
            Some(library) => terms.iter().map(|t| slot(library, t)).collect(),
            None => vec![None; terms.len()],
        }
    }

    fn slot(&self, library: &Library, wanted: &str) -> Option<usize> {
        let language = Language(&self.model);
        // Filtering the lists first is cheap: they are short even if their product is long.
        let spelled = |term: &Term| {
            let mut atoms = term.factors().map(|(atom, _)| atom);
            atoms.all(|a| wanted.contains(&language.term(&Term::atom(a.clone()))))
        };
        let wanted = factors(wanted);
        let mut first = 0;
        for block in library.blocks() {
            let kept = |terms: &[Term]| -> Vec<usize> {
                let places = terms.iter().enumerate();
                places.filter(|(_, t)| spelled(t)).map(|p| p.0).collect()
            };
            let (left, right) = (kept(&block.left), kept(&block.right));
            for slot in left
                .iter()
                .flat_map(|i| right.iter().map(move |j| first + i * block.right.len() + j))
            {
                let term = library.term(slot).map(|t| language.term(&t));
                let same = term.is_some_and(|t| factors(&t) == wanted);
                if same && !library.is_empty_slot(slot) {
                    return Some(slot);
                }
            }
            first += block.slots();
        }
        None
    }

    fn place(&self, target: &str) -> Option<usize> {
        let named = |s: Signal| self.model.name(s) == target;
        self.model.equations.iter().position(|e| named(e.target))
    }
}

/// The factors of a term, split at each `*` outside brackets and sorted.
fn factors(term: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    let mut parts: Vec<&str> = term
        .split(|c: char| {
            match c {
                '(' => depth += 1,
                ')' => depth = depth.saturating_sub(1),
                _ => {}
            }
            c == '*' && depth == 0
        })
        .map(str::trim)
        .collect();
    parts.sort_unstable();
    parts
}
