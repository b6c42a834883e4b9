//! The errors of free runs: their memory, their spectrum, what they share with inputs and states.

use crate::report::markup::{Section, lead};
use crate::report::report_contents::{Record, Subject};
use crate::report::sections::{
    residual_autocorrelation, residual_cross_correlation, residual_means, residual_spectrum,
};
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Signal, VarId};

/// Figures of one kind.
const MAX_FIGURES: usize = 6;

pub(crate) fn html(s: &Subject) -> Section {
    let records = s.records();
    let Some(record) = records.first() else {
        return Section::default();
    };
    // Errors too small to be noise of a sensor are those of rounding and of the start.
    let shown = |x: &Signal| record.residual(*x).is_some() && !is_exact(record, *x);
    let signals: Vec<Signal> = record.simulated().into_iter().filter(shown).collect();
    // Those that the equations leave out are of more interest than the others.
    let variables = (0u16..).zip(&s.discovery.variables);
    let inputs = variables.filter(|(_, v)| v.kind == VarKind::Input);
    let inputs: Vec<Signal> = inputs.map(|(id, _)| Signal::new(VarId(id))).collect();
    let pairs = || {
        signals
            .iter()
            .flat_map(|x| inputs.iter().map(move |u| (*x, *u)))
    };
    let states = || {
        signals
            .iter()
            .flat_map(|x| signals.iter().map(move |y| (*x, *y)))
    };
    let groups = [
        group(
            "Memory",
            "If the equations and the start were exact, the errors would be the sensor's noise alone, and, for white noise, 95 % of the lines would end within the band.",
            signals
                .iter()
                .filter_map(|x| residual_autocorrelation::picture(s, record, *x)),
        ),
        group(
            "Spectrum",
            "White noise has the same power at all frequencies. A peak is a motion that the equations have not, or have at another frequency.",
            signals
                .iter()
                .filter_map(|x| residual_spectrum::picture(s, record, *x)),
        ),
        group(
            "With the inputs",
            "Correlation of the error with the input so many samples before. Beyond the band the input still tells of the error: its effect is late, has another shape, or is missing.",
            pairs().filter_map(|(x, u)| residual_cross_correlation::picture(s, record, x, u)),
        ),
        group(
            "Along the states",
            "Means of the error over tenths of the readings, by the value of the state, with twice their standard error as if errors were independent. A curve is a term that the equations have not.",
            states().filter_map(|(x, y)| residual_means::picture(s, record, x, y)),
        ),
    ];
    let body = groups.concat();
    if body.is_empty() {
        return Section::default();
    }
    let how = format!(
        "{}: simulated less measured, of free runs.",
        record.trajectory.name
    );
    Section::new("residuals", "What the errors show", lead(&how) + &body)
}

fn group(title: &str, how: &str, pictures: impl Iterator<Item = String>) -> String {
    let pictures: String = pictures.take(MAX_FIGURES).collect();
    match pictures.is_empty() {
        true => pictures,
        false => format!(
            "<h3>{}</h3>\n{}<div class=\"thirds\">\n{pictures}</div>\n",
            escape(title),
            lead(how)
        ),
    }
}

fn is_exact(r: &Record, x: Signal) -> bool {
    r.scores(x)
        .all(|(_, _, c)| 1.0 - c.fit / 100.0 < FIGURES.exact_run)
}
