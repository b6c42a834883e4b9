//! Coverage of the data: histograms of signals and of pairs, over all records. Outside it the equations are untested.

use crate::report::figure::axis::{Axis, extremes};
use crate::report::figure::density_grid::DensityGrid;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH};
use crate::report::figure::plot::path;
use crate::report::markup::{Section, lead, number};
use crate::report::report_contents::{RecordRun, Subject};
use crate::typeset::mathml::escape;
use sidc_data::Trajectory;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::Excitation;

/// Most signals that are plotted against each other.
const MAX_SIGNALS: usize = 5;
const BINS: usize = 32;
const CELLS_PER_SIDE: usize = 48;

/// A signal with all its readings.
struct Series {
    name: String,
    /// A series for each record.
    values: Vec<Vec<f64>>,
    axis: Axis,
    /// True if no record measured it; the simulation is shown instead.
    simulated: bool,
}

pub(crate) fn html(s: &Subject) -> Section {
    let all = signals(s);
    let drawn = all.iter().take(MAX_SIGNALS).collect::<Vec<_>>();
    let mut body = String::new();
    if !drawn.is_empty() {
        body.push_str(&lead(
            "Every record given, states and inputs against each other; darker cells were met more often. On the diagonal, how often each value was met. \
             What the equations say outside is extrapolation.",
        ));
        body.push_str(&pairs(&drawn));
        if all.len() > MAX_SIGNALS {
            body.push_str(&format!(
                "<p>{} more signals are in the table.</p>\n",
                all.len() - MAX_SIGNALS
            ));
        }
    }
    body.push_str(&table(s, &all));
    Section::new("coverage", "Where the data were", body)
}

/// States with their lower derivatives, then inputs.
fn signals(s: &Subject) -> Vec<Series> {
    let d = s.discovery;
    let of = |kind: VarKind| {
        let all = (0u16..).zip(&d.variables);
        all.filter(move |(_, v)| v.kind == kind)
    };
    let mut wanted = Vec::new();
    for (id, v) in of(VarKind::State) {
        let top = if d.discrete { 1 } else { v.order.max(1) };
        let id = sidc_lang::term::VarId(id);
        wanted.extend((0..top).map(|der| Signal::derivative(id, der)));
    }
    wanted.extend(of(VarKind::Input).map(|(id, _)| Signal::new(sidc_lang::term::VarId(id))));
    wanted.into_iter().filter_map(|x| series(s, x)).collect()
}

fn series(s: &Subject, x: Signal) -> Option<Series> {
    let measured = |x: Signal| -> Vec<Vec<f64>> {
        let all = s.dataset.trajectories.iter();
        all.map(|t| t.column(x).map(<[f64]>::to_vec).unwrap_or_default())
            .collect()
    };
    let known = |all: &[Vec<f64>]| all.iter().flatten().any(|v| v.is_finite());
    let mut values = measured(x);
    let simulated = !known(&values);
    if simulated {
        let rows = |t: &Trajectory| vec![f64::NAN; t.len()];
        values = s.dataset.trajectories.iter().map(rows).collect();
        s.runs
            .iter()
            .for_each(|a| copy_to_rows(s, a, x, &mut values));
    }
    let axis = Axis::over(values.iter().flatten())?;
    Some(Series {
        name: s.discovery.name(x),
        values,
        axis,
        simulated,
    })
}

/// Copies a simulated signal to the rows of its record.
fn copy_to_rows(s: &Subject, a: &RecordRun, x: Signal, values: &mut [Vec<f64>]) {
    let all = (s.dataset.trajectories.get(a.trajectory)).zip(values.get_mut(a.trajectory));
    let (Some((trajectory, row)), Ok(run)) = (all, &a.run) else {
        return;
    };
    let (Some(first), Some(column)) = (run.time.first(), run.column(x)) else {
        return;
    };
    let begin = trajectory.time.partition_point(|t| t < first);
    for (to, value) in row.iter_mut().skip(begin).zip(column) {
        *to = *value;
    }
}

/// The lower triangle of all pairs; histograms on the diagonal.
fn pairs(all: &[&Series]) -> String {
    let n = all.len();
    let mut out = format!("<div class=\"pairs\" style=\"--n:{n}\">\n");
    for (i, y) in all.iter().enumerate() {
        for (j, x) in all.iter().enumerate().take(i + 1) {
            let at = format!("grid-row:{};grid-column:{}", i + 1, j + 2);
            out.push_str(&match i == j {
                true => histogram(x, &at),
                false => pair(x, y, &at),
            });
        }
        let range = |v: f64| number(v, 2);
        out.push_str(&format!(
            "<div class=\"side\" style=\"grid-row:{};grid-column:1\" aria-hidden=\"true\"><b>{}</b><small>{} to {}</small></div>\n",
            i + 1,
            escape(&y.name),
            range(y.axis.low),
            range(y.axis.high)
        ));
        out.push_str(&format!(
            "<div class=\"foot\" style=\"grid-row:{};grid-column:{}\" aria-hidden=\"true\">{}</div>\n",
            n + 1,
            i + 2,
            escape(&y.name)
        ));
    }
    out + "</div>\n"
}

fn svg(at: &str, alt: &str, elements: &str) -> String {
    format!(
        "<svg role=\"img\" aria-label=\"{}\" style=\"{at}\" viewBox=\"0 0 {BOX_WIDTH} {BOX_HEIGHT}\" preserveAspectRatio=\"none\">{elements}</svg>\n",
        escape(alt)
    )
}

fn histogram(x: &Series, at: &str) -> String {
    let mut counts = [0usize; BINS];
    for v in x.values.iter().flatten().filter(|v| v.is_finite()) {
        let bin = (x.axis.share(*v) * BINS as f64) as usize;
        if let Some(count) = counts.get_mut(bin.min(BINS - 1)) {
            *count += 1;
        }
    }
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let mut d = String::new();
    for (k, count) in counts.iter().enumerate().filter(|(_, c)| **c > 0) {
        let edge = |k: usize| (k as i32 * BOX_WIDTH) / BINS as i32;
        let high = (*count as f64 / most as f64 * 0.94 * f64::from(BOX_HEIGHT)).ceil() as i32;
        let wide = edge(k + 1) - edge(k);
        d.push_str(&format!("M{} {BOX_HEIGHT}v-{high}h{wide}v{high}z", edge(k)));
    }
    let alt = format!(
        "how often each value of {} was met, {} to {}",
        x.name,
        number(x.axis.low, 3),
        number(x.axis.high, 3)
    );
    svg(at, &alt, &path("bins", &d))
}

fn pair(x: &Series, y: &Series, at: &str) -> String {
    let mut plane = DensityGrid::new(CELLS_PER_SIDE);
    for (xs, ys) in x.values.iter().zip(&y.values) {
        for (a, b) in xs.iter().zip(ys) {
            plane.add(x.axis.share(*a), y.axis.share(*b));
        }
    }
    let levels = [1, plane.quantile(0.5).max(2), plane.quantile(0.9).max(3)];
    let elements: String = (levels.iter())
        .map(|least| path("cells", &plane.path(*least)))
        .collect();
    svg(
        at,
        &format!("where {} and {} were together", y.name, x.name),
        &elements,
    )
}

fn table(s: &Subject, all: &[Series]) -> String {
    let judged = s
        .discovery
        .equations
        .iter()
        .filter_map(|e| e.evidence.as_ref());
    let known: Vec<&Excitation> = judged
        .filter_map(|e| e.identifiability.as_deref())
        .flat_map(|i| &i.excitation)
        .collect();
    let rows: String = all
        .iter()
        .filter_map(|series| {
            let (low, high) = extremes(series.values.iter().flatten())?;
            let own = known.iter().find(|e| e.signal == series.name);
            let band = own.and_then(|e| e.band).map_or("–".into(), |b| number(b, 3));
            let line = own.and_then(|e| e.line).filter(|l| l.0 > 0.0);
            let line = line.map_or("–".into(), |(f, share)| {
                format!("{} ({} %)", number(f, 3), number(100.0 * share, 2))
            });
            let how = if series.simulated { "simulated" } else { "measured" };
            Some(format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{line}</td><td>{band}</td><td>{how}</td></tr>\n",
                escape(&series.name),
                number(low, 4),
                number(high, 4)
            ))
        })
        .collect();
    if rows.is_empty() {
        return rows;
    }
    let per = s.discovery.frequency_unit();
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"ranges of the signals\"><table>\n<thead><tr><th scope=\"col\">signal</th><th scope=\"col\">least</th><th scope=\"col\">greatest</th>\
         <th scope=\"col\">strongest line ({per})</th><th scope=\"col\">95 % of power under ({per})</th><th scope=\"col\">here</th></tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}
