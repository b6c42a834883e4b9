//! What `identify` prints and writes: equations with evidence, rows, signals; or the same as a document.

use super::arguments::Args;
use super::next_step;
use super::search::{Candidate, Identified, Search};
use crate::exit_status;
use crate::failure::Failure;
use crate::outputs::{files, signals, stdout};
use sidc::pipeline;
use sidc_emit as emit;
use sidc_system::result;
use sidc_system::result::{CandidateEntry, Settings};

/// The answer, and how it was found.
pub struct Answer<'a> {
    pub args: &'a Args,
    pub search: &'a Search,
    pub candidate: &'a Candidate,
    pub found: &'a Identified,
    /// All candidates, if there is more than one.
    pub others: &'a [CandidateEntry],
}

impl Answer<'_> {
    /// Writes and prints the answer. Returns the exit status.
    ///
    /// # Errors
    /// A file that cannot be written; the answer is printed anyway.
    pub fn print(&self) -> Result<u8, Failure> {
        let document = self.document()?;
        // The disk may be full, so a failure is returned only after the answer is printed.
        let output = self.args.output.as_ref();
        let written = output.map(|path| files::write(path, &document));
        if self.args.json {
            stdout::print(&document)?;
        } else {
            stdout::print_readable(&self.text())?;
        }
        written.transpose()?;
        // If limits of prediction errors were given, they decide the exit status; doubts are printed in any case.
        let passes = || self.found.discovery.passes();
        Ok(
            match self.found.verdict.prediction.good.unwrap_or_else(passes) {
                true => exit_status::PASS,
                false => exit_status::DOUBT,
            },
        )
    }

    fn text(&self) -> String {
        let (measured, d) = (&self.candidate.measured, &self.found.discovery);
        let mut text = String::new();
        if !self.others.is_empty() {
            text.push_str(&comparison_table(self.others, &d.time_unit()));
            text.push('\n');
        }
        let rows = measured.rows();
        let drawn = match self.args.samples {
            Some(n) if (n as usize) < rows => format!(" ({n} drawn, seed {})", self.args.seed),
            _ => String::new(),
        };
        let mut evidence = d.equations.iter().filter_map(|e| e.evidence.as_ref());
        let is_joint = measured.joint.is_some() || evidence.any(|e| e.joint.is_some());
        let rows = match rows {
            0 => "no rows were ready".into(),
            n if is_joint => format!("{n} samples"),
            n => format!("{n} rows{drawn}"),
        };
        text.push_str(&format!(
            "{}: {rows} from {}\n\n",
            d.system.as_deref().unwrap_or("system"),
            signals::trajectories(measured)
        ));
        text.push_str(&emit::answer(d, &self.found.verdict));
        text.push('\n');
        if self.args.evidence {
            text.push_str(&self.evidence());
            text.push('\n');
        }
        let held_out = !measured.held_out.is_empty();
        let found = (d, &self.found.verdict.prediction);
        text.push_str(&next_step::line(
            self.args,
            &self.candidate.source,
            found,
            held_out,
        ));
        text
    }

    /// What supports the equations, and what follows from them.
    fn evidence(&self) -> String {
        let d = &self.found.discovery;
        let runs = self.found.validation.as_ref();
        let runs = runs.map(|v| format!("\n{}", emit::validation(v)));
        format!(
            "{}{}{}\n{}",
            emit::evidence(d),
            emit::derived_forms(d),
            runs.unwrap_or_default(),
            signals::describe(&self.candidate.program, &self.candidate.measured)
        )
    }

    fn document(&self) -> Result<String, Failure> {
        let Candidate {
            source,
            program,
            measured,
            warnings,
        } = self.candidate;
        let Search { data, options, .. } = self.search;
        let beside = result::DocumentContext {
            // The window as the user gave it.
            settings: Settings {
                window: self.args.window,
                ..pipeline::settings(source, program, measured, data, options)
            },
            signals: pipeline::signal_entries(program, measured),
            warnings: warnings.clone(),
            validation: self.found.validation.clone(),
            verdict: Some(self.found.verdict.clone()),
            candidates: self.others.to_vec(),
        };
        result::write(&self.found.discovery, beside).map_err(Failure::internal)
    }
}

/// The table of all candidates with their errors.
fn comparison_table(entries: &[CandidateEntry], time_unit: &str) -> String {
    let width = entries.iter().map(|e| e.model.chars().count()).max();
    let width = width.unwrap_or(0).max("model".len());
    let seconds = entries.first().map_or(0.0, |e| e.seconds);
    let mut text = format!(
        "candidates by the error of their free runs on data not used, {} {time_unit} long; of those within 1 dB of the least\n\
         (or below -100 dB) the one with the fewest terms is best\n",
        sidc_lang::number::significant(seconds, 3)
    );
    text.push_str(&format!("  {:<width$}  terms  error (dB)\n", "model"));
    for e in entries {
        let error = e.error_db.map_or("ended".into(), |x| format!("{x:.1}"));
        let mut marks = Vec::new();
        if e.best {
            marks.push("best");
        } else if e.front {
            marks.push("on the Pareto front");
        }
        if !e.passes {
            marks.push("doubted");
        }
        let line = format!(
            "  {:<width$}  {:>5}  {error:>10}  {}",
            e.model,
            e.terms,
            marks.join(", ")
        );
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
