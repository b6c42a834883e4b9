//! How inputs move between samples, and where held ones jump.
//!
//! In: declarations and records. Out: hold or linear for every input, told where it was not declared.

use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{Between, Model, VarKind};
use crate::term::Signal;

use super::{Input, Trajectory};

/// Hold or linear for every measured input, in order of declaration.
///
/// Undeclared inputs are held if at least half of their consecutive differences are exactly zero: a zero-order hold
/// repeats its values when it is sampled faster than it is set, a sampled smooth signal hardly ever does.
pub(super) fn decide(
    model: &Model,
    trajectories: &[Trajectory],
    out: &mut Vec<Diagnostic>,
) -> Vec<Input> {
    let mut inputs = Vec::new();
    if model.discrete {
        // Between samples there is nothing.
        return inputs;
    }
    for (id, var) in model.vars_of(VarKind::Input) {
        let signal = Signal::new(id);
        let (mut still, mut all) = (0usize, 0usize);
        for column in trajectories.iter().filter_map(|t| t.column(signal)) {
            all += column.len().saturating_sub(1);
            still += column.windows(2).filter(|w| w[0] == w[1]).count();
        }
        if all == 0 && var.between.is_none() {
            continue;
        }
        let between = var.between.unwrap_or_else(|| {
            let hold = 2 * still >= all;
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

fn assumed(name: &str, hold: bool, still: usize, all: usize) -> Diagnostic {
    let (how, word) = if hold {
        ("held from sample to sample", "hold")
    } else {
        ("linear between samples", "linear")
    };
    let percent = 100.0 * still as f64 / all.max(1) as f64;
    Diagnostic::note("input-between", format!("input {name} is taken as {how}"))
        .fact(format!("{percent:.0} % of its steps are exactly zero"))
        .help(format!("say so: input {name} : {word}"))
}

/// Rows of a trajectory at which a held input jumps: u_k holds from t_k on, so row k opens a new segment.
pub(super) fn jumps(inputs: &[Input], trajectory: &Trajectory) -> Vec<usize> {
    let held = |i: &&Input| i.between == Between::Hold;
    let mut out: Vec<usize> = inputs
        .iter()
        .filter(held)
        .filter_map(|i| trajectory.column(Signal::new(i.var)))
        .flat_map(|u| {
            u.windows(2)
                .enumerate()
                .filter(|(_, w)| w[0] != w[1])
                .map(|(k, _)| k + 1)
        })
        .collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// What the samples of a driven signal cannot show: how far its highest derivative at a sample may be from that of a smooth
/// curve through the samples, relative to its size, if the input moves it all. Both of the trajectory's length.
#[derive(Clone, Debug, Default)]
pub(super) struct Unseen {
    /// Where a window steps over the jumps of held inputs: the curve follows the middle of a jump, the derivative its end.
    pub across: Vec<f64>,
    /// Everywhere, from inputs that are linear between samples: the curve rounds their corners off.
    pub corners: Vec<f64>,
}

/// Rows to both sides whose jumps and corners count.
const NEAR: usize = 3;

pub(super) fn unseen(inputs: &[Input], trajectory: &Trajectory) -> Unseen {
    let rows = trajectory.len();
    let mut out = Unseen {
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
        };
        for (row, worst) in into.iter_mut().enumerate() {
            let near = moves.iter().skip(row.saturating_sub(NEAR)).take(2 * NEAR);
            *worst = near.fold(*worst, |m, x| m.max(x / size));
        }
    }
    out
}
