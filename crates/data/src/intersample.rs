//! Intersample behaviour of inputs: zero-order hold or linear, where held inputs jump, and what that hides from the samples.
//!
//! In: declarations and records. Out: hold or linear for every input, with a note where it was not declared; rows of jumps;
//! errors for derivatives; values between readings. The term is Ljung's (System Identification, 2nd ed. 1999, ch. 13).

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Between, Model, VarKind};
use sidc_lang::term::Signal;

use crate::cubic::Cubic;
use crate::dataset::{Input, Trajectory};
use crate::series::rows_of_steps;
use crate::time_axis;

sidc_thresholds::family! {
    /// How inputs are taken to move between samples.
    pub(crate) INTERSAMPLE: IntersampleThresholds {
        /// Consecutive differences of an undeclared input that are zero if it is held.
        held: f64 = 0.5, unit "of all differences", source "set by hand";
        /// Rows on either side whose jumps and corners add to the error of a derivative.
        reach: usize = 3, unit "rows", source "with two, an aliased record of the study gets other terms; six change nothing";
    }
}

/// Hold or linear for every measured input, in order of declaration.
///
/// An undeclared input is held if enough of its consecutive differences are exactly zero: a zero-order hold repeats its value
/// when it is sampled faster than it is set, and a smooth signal hardly ever does.
pub(crate) fn infer(
    model: &Model,
    trajectories: &[&Trajectory],
    out: &mut Vec<Diagnostic>,
) -> Vec<Input> {
    let mut inputs = Vec::new();
    if model.discrete {
        // In discrete time there is nothing between samples.
        return inputs;
    }
    for (id, var) in model.vars_of(VarKind::Input) {
        let signal = Signal::new(id);
        let (mut still, mut all) = (0usize, 0usize);
        for column in trajectories.iter().filter_map(|t| t.column(signal)) {
            let known: Vec<f64> = column.iter().copied().filter(|u| u.is_finite()).collect();
            all += known.len().saturating_sub(1);
            still += known.windows(2).filter(|w| w[0] == w[1]).count();
        }
        if all == 0 && var.between.is_none() {
            continue;
        }
        let between = var.between.unwrap_or_else(|| {
            let hold = still as f64 >= INTERSAMPLE.held * all as f64;
            out.push(assumed(&var.name, hold, still, all));
            if hold { Between::Hold } else { Between::Linear }
        });
        inputs.push(Input {
            var: id,
            between,
            declared: var.between.is_some(),
        });
    }
    inputs
}

/// Fills in values of inputs between their readings, as for inputs recorded at a lower rate than the states, as it is
/// declared or inferred to move there. No values are filled in where readings are as far apart as a gap.
pub(crate) fn fill(inputs: &[Input], trajectory: &mut Trajectory) {
    let time = &trajectory.time;
    for (signal, values) in &mut trajectory.columns {
        let Some(input) = inputs.iter().find(|i| *signal == Signal::new(i.var)) else {
            continue;
        };
        let known: Vec<usize> = (0..values.len())
            .filter(|k| values[*k].is_finite())
            .collect();
        let times: Vec<f64> = known.iter().map(|k| time[*k]).collect();
        let readings: Vec<f64> = known.iter().map(|k| values[*k]).collect();
        let gaps = time_axis::gaps(&times);
        for (place, pair) in known.windows(2).enumerate() {
            let (a, b) = (pair[0], pair[1]);
            if gaps.binary_search(&(place + 1)).is_ok() {
                continue;
            }
            let cubic = match input.between {
                Between::Cubic => Cubic::within_gaps(&times, &readings, &gaps, place),
                Between::Hold | Between::Linear => None,
            };
            match cubic {
                Some(cubic) => (a + 1..b).for_each(|k| values[k] = cubic.at(time[k] - time[a])),
                None => fill_between(input.between, time, values, (a, b)),
            }
        }
    }
}

/// Gives a signal values at the rows between two of its readings, held or straight.
pub fn fill_between(between: Between, time: &[f64], values: &mut [f64], (a, b): (usize, usize)) {
    let (start, end) = (values[a], values[b]);
    for k in a + 1..b {
        let part = (time[k] - time[a]) / (time[b] - time[a]);
        values[k] = match between {
            Between::Hold => start,
            Between::Linear | Between::Cubic => start + part * (end - start),
        };
    }
}

fn assumed(name: &str, hold: bool, still: usize, all: usize) -> Diagnostic {
    let (how, word) = if hold {
        ("held from sample to sample", Between::Hold.word())
    } else {
        ("linear between samples", Between::Linear.word())
    };
    let percent = 100.0 * still as f64 / all.max(1) as f64;
    Diagnostic::note("input-between", format!("input {name} is taken as {how}"))
        .fact(format!("{percent:.0} % of its steps are exactly zero"))
        .help(format!("say so: input {name} : {word}"))
}

/// Rows of a trajectory at which a held input jumps. u_k holds from t_k on, so row k starts a new segment.
pub(crate) fn jumps(inputs: &[Input], trajectory: &Trajectory) -> Vec<usize> {
    let held = |i: &&Input| i.between == Between::Hold;
    let mut out: Vec<usize> = inputs
        .iter()
        .filter(held)
        .filter_map(|i| trajectory.column(Signal::new(i.var)))
        .flat_map(|u| rows_of_steps(u, |a, b| a != b))
        .collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// How far the highest derivative of a variable may be from that of a smooth curve through its samples, relative to its size,
/// because of jumps and corners of inputs between samples; as if the input alone moved it. Both vectors have the trajectory's
/// length.
#[derive(Clone, Debug, Default)]
pub(crate) struct IntersampleError {
    /// For windows across jumps of held inputs: half a jump, since the curve follows its middle.
    pub across: Vec<f64>,
    /// For inputs that are linear between samples, whose corners a curve rounds off: a twelfth of the second difference.
    pub corners: Vec<f64>,
}

pub(crate) fn intersample_error(inputs: &[Input], trajectory: &Trajectory) -> IntersampleError {
    let rows = trajectory.len();
    let mut out = IntersampleError {
        across: vec![0.0; rows],
        corners: vec![0.0; rows],
    };
    for input in inputs {
        let Some(u) = trajectory.column(Signal::new(input.var)) else {
            continue;
        };
        let size = (u.iter().map(|x| x * x).sum::<f64>() / rows.max(1) as f64).sqrt();
        if !(size > 0.0 && size.is_finite()) {
            continue;
        }
        let (into, moves): (&mut Vec<f64>, Vec<f64>) = match input.between {
            Between::Hold => (
                &mut out.across,
                u.windows(2).map(|w| 0.5 * (w[1] - w[0]).abs()).collect(),
            ),
            Between::Linear => (
                &mut out.corners,
                u.windows(3)
                    .map(|w| (w[2] - 2.0 * w[1] + w[0]).abs() / 12.0)
                    .collect(),
            ),
            Between::Cubic => continue,
        };
        for (row, worst) in into.iter_mut().enumerate() {
            let near = moves
                .iter()
                .skip(row.saturating_sub(INTERSAMPLE.reach))
                .take(2 * INTERSAMPLE.reach);
            *worst = near.fold(*worst, |m, x| m.max(x / size));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use sidc_lang::term::VarId;

    use super::*;

    fn filled(between: Between, time: &[f64], values: &[f64]) -> Vec<f64> {
        let u = VarId(1);
        let mut trajectory = Trajectory {
            time: time.to_vec(),
            columns: vec![(Signal::new(u), values.to_vec())],
            ..Trajectory::default()
        };
        let input = Input {
            var: u,
            between,
            declared: true,
        };
        fill(&[input], &mut trajectory);
        trajectory.columns.swap_remove(0).1
    }

    #[test]
    fn an_input_of_another_rate_has_values_between_its_readings() {
        let none = f64::NAN;
        let time = [0.0, 0.1, 0.4, 1.0, 1.5, 2.0];
        let values = [none, 1.0, none, 4.0, none, 2.0];
        let linear = filled(Between::Linear, &time, &values);
        assert!(linear[0].is_nan());
        let expected = [1.0, 2.0, 4.0, 3.0, 2.0];
        assert!(
            linear[1..]
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        assert_eq!(
            filled(Between::Hold, &time, &values)[1..],
            [1.0, 1.0, 4.0, 4.0, 2.0]
        );
        let square = |t: &f64| t * t;
        let time: Vec<f64> = (0..13).map(|k| 0.1 * f64::from(k)).collect();
        let read = |(k, t): (usize, &f64)| if k % 4 == 0 { square(t) } else { none };
        let values: Vec<f64> = time.iter().enumerate().map(read).collect();
        let cubic = filled(Between::Cubic, &time, &values);
        let truth = time.iter().map(square);
        assert!(cubic.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn nothing_is_known_of_an_input_in_its_gaps() {
        let time: Vec<f64> = (0..60).map(f64::from).collect();
        let read = |k: usize| k.is_multiple_of(2) && !(20..40).contains(&k);
        let values: Vec<f64> = (0..60)
            .map(|k| if read(k) { 1.0 } else { f64::NAN })
            .collect();
        let linear = filled(Between::Linear, &time, &values);
        assert!(linear[19..39].iter().all(|u| u.is_nan()), "{linear:?}");
        assert!(
            linear[..19]
                .iter()
                .chain(&linear[40..59])
                .all(|u| *u == 1.0)
        );
    }
}
