//! The errors of free runs: their autocorrelation, their spectrum, how they depend on inputs and states.

use crate::report::markup::{Section, lead};
use crate::report::report_contents::{Record, Subject};
use crate::report::sections::correlation::Series;
use crate::report::sections::residual_correlation::{with_input, with_itself};
use crate::report::sections::trajectories::SENSITIVE;
use crate::report::sections::{residual_means, residual_spectrum};
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Signal, VarId};

/// Most figures of one kind.
const MAX_FIGURES: usize = 6;

pub(crate) fn html(s: &Subject) -> Section {
    let records = s.records();
    let Some(record) = records.first() else {
        return Section::default();
    };
    let all = record.simulated().into_iter();
    let all: Vec<Errors> = all.filter_map(|x| Errors::new(record, x)).collect();
    let Some(first) = all.first() else {
        return Section::default();
    };
    const TITLE: &str = "What the errors show";
    if s.is_sensitive() {
        return Section::new("residuals", TITLE, SENSITIVE.into());
    }
    let inputs = inputs(s, record, &first.time);
    let pairs = all
        .iter()
        .flat_map(|e| inputs.iter().map(move |(u, input)| (e, *u, input)));
    let along = all
        .iter()
        .flat_map(|e| all.iter().map(move |state| (e, state.signal)));
    let groups = [
        group(
            "Memory",
            "If the equations and the start were exact, the errors would be the sensor's noise alone, and, for white noise, 95 % of the lines would end within the band.",
            all.iter()
                .filter_map(|e| Some(with_itself(s, e.signal, e.series.as_ref()?))),
        ),
        group(
            "Spectrum",
            "White noise has the same power at all frequencies. A peak is a motion that the equations have not, or have at another frequency.",
            all.iter()
                .filter_map(|e| residual_spectrum::picture(s, e.signal, (&e.time, &e.values))),
        ),
        group(
            "With the inputs",
            "Correlation of the error with the input so many samples before. Beyond the band the input still tells of the error: its effect is late, has another shape, or is missing.",
            pairs.filter_map(|(e, u, input)| {
                Some(with_input(s, (e.signal, e.series.as_ref()?), (u, input)))
            }),
        ),
        group(
            "Along the states",
            "Means of the error over tenths of the readings, by the value of the state, with twice their standard error as if errors were independent. A curve is a term that the equations have not.",
            along.filter_map(|(e, state)| {
                let (_, values) = record.column(state)?;
                residual_means::picture(s, (e.signal, &e.values), (state, &values))
            }),
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
    Section::new("residuals", TITLE, lead(&how) + &body)
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

/// The errors of one signal.
struct Errors {
    signal: Signal,
    time: Vec<f64>,
    values: Vec<f64>,
    /// `None` if they do not vary or are too few.
    series: Option<Series>,
}

impl Errors {
    /// `None` if there are none, or if they are too small to be sensor noise: then they come from rounding and from the start.
    fn new(r: &Record, signal: Signal) -> Option<Errors> {
        let mut scores = r.scores(signal);
        if scores.all(|(_, _, c)| 1.0 - c.fit / 100.0 < FIGURES.exact_run) {
            return None;
        }
        let (time, values) = r.residual(signal)?;
        let series = Series::new(&values, FIGURES.lags);
        Some(Errors {
            signal,
            time,
            values,
            series,
        })
    }
}

/// The inputs that vary, including those that no equation uses: the errors may show that one of them is missing.
fn inputs(s: &Subject, r: &Record, time: &[f64]) -> Vec<(Signal, Series)> {
    let variables = (0u16..).zip(&s.discovery.variables);
    let inputs = variables.filter(|(_, v)| v.kind == VarKind::Input);
    let series = |u: Signal| {
        let applied = r.input(u).map(|(_, values)| values);
        let values = applied.or_else(|| r.read_at(u, time))?;
        Some((u, Series::new(&values, FIGURES.lags)?))
    };
    inputs
        .filter_map(|(id, _)| series(Signal::new(VarId(id))))
        .collect()
}
