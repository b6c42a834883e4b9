//! Inputs that are read with noise: they become states, whose readings are as good as the model says.
//!
//! In: a problem, the noise of held inputs. Out: the problem in which they are estimated. Estimates nothing.

use super::disturbance_states::widened;
use super::estimation_problem::Problem;
use super::process_noise::{NoisyInput, ProcessNoise};
use super::record::Exogenous;
use crate::trajectory::thresholds::INPUT_NOISE;
use sidc_lang::term::Signal;

impl Problem {
    /// Whether a signal is an input that is held between the samples of all records.
    pub fn holds(&self, signal: Signal) -> bool {
        let Some(place) = self.system.exogenous.iter().position(|s| *s == signal) else {
            return false;
        };
        let mut records = self.records.iter().map(|r| r.exogenous.get(place));
        records.all(|o| o.is_some_and(Exogenous::is_held))
    }

    /// Whether inputs are estimated.
    pub(crate) fn has_noisy_inputs(&self) -> bool {
        self.input_noise.iter().any(Option::is_some)
    }

    /// The values of an exogenous signal in all records; empty if the system has no such signal.
    pub(crate) fn values_of_input(&self, signal: Signal) -> Vec<f64> {
        let place = self.system.exogenous.iter().position(|s| *s == signal);
        let records = self.records.iter();
        let own = records.filter_map(|r| r.exogenous.get(place?));
        own.flat_map(|o| o.values.iter().copied()).collect()
    }

    /// The problem with these inputs as states that nothing moves: each reading says what it is until the next.
    pub fn with_noisy_inputs(&self, inputs: &[(Signal, f64)]) -> Problem {
        let mut problem = self.clone();
        let mut process = ProcessNoise::white(&self.system, |_| 0.0);
        for (signal, noise) in inputs {
            let Some(place) = problem.system.exogenous.iter().position(|s| s == signal) else {
                continue;
            };
            let n = problem.states();
            problem.system.exogenous.remove(place);
            problem.system.noisy_exogenous.remove(place);
            problem.system.states.push(*signal);
            let (step, _) = problem.step_and_length();
            let records = problem
                .records
                .iter()
                .map(|r| &r.exogenous[place].values[..]);
            let course = course(records, *noise, step);
            for (record, curve) in problem.records.iter_mut().zip(&mut problem.smoothed) {
                let values = record.exogenous.remove(place).values;
                curve.states = widened(&curve.states, n, n + 1, 0.0);
                let column = curve.states.iter_mut().skip(n).step_by(n + 1);
                column.zip(&values).for_each(|(x, value)| *x = *value);
                curve.noise.push(None);
                record.measured.push(values);
            }
            problem.sensors = problem.sensors.with_states(n + 1);
            problem.growth = widened(&problem.growth, n, n + 1, None);
            problem.spread.push(course.deviation);
            problem.input_noise.push(Some(*noise));
            problem.declared.push(None);
            problem.declared_memory.push(None);
            process.inputs.push(NoisyInput { state: n, ..course });
        }
        problem.compile_columns();
        problem.update_noise();
        let n = problem.states();
        for (sensor, level) in problem.noise.iter_mut().enumerate() {
            *level = problem.input_noise[sensor % n].unwrap_or(*level);
        }
        problem.process = Some(process);
        problem
    }
}

/// Mean, deviation and memory (s) of an input from its readings: the deviation from their variance less that of the noise, the memory from
/// their correlation from one sample to the next.
fn course<'a>(
    records: impl Iterator<Item = &'a [f64]> + Clone,
    noise: f64,
    step: f64,
) -> NoisyInput {
    let values = || records.clone().flatten();
    let count = values().count().max(1) as f64;
    let mean = values().sum::<f64>() / count;
    let square = values().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let pairs = records.clone().flat_map(|r| r.windows(2));
    let shared = pairs.map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>() / count;
    let [least, most] = INPUT_NOISE.correlation;
    // An input whose variance hardly exceeds that of its noise keeps a share of it, so that its deviation is positive.
    let own = (square - noise * noise).max(INPUT_NOISE.least_share * square);
    let correlation = (shared / own).clamp(least, most);
    NoisyInput {
        state: 0,
        mean,
        deviation: own.sqrt().max(f64::MIN_POSITIVE),
        memory: -step / correlation.ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::course;

    #[test]
    fn the_course_of_an_input_is_that_without_its_noise() {
        // ±1 in turn for four samples, read 0.5 too high and too low in turn.
        let u = |k: usize| if (k / 4).is_multiple_of(2) { 1.0 } else { -1.0 };
        let error = |k: usize| if k.is_multiple_of(2) { 0.5 } else { -0.5 };
        let read: Vec<f64> = (0..800).map(|k| u(k) + error(k)).collect();
        let course = course([&read[..]].into_iter(), 0.5, 0.1);
        assert!(course.mean.abs() < 1e-12);
        assert!((course.deviation - 1.0).abs() < 1e-12);
        assert!(course.memory > 0.0);
    }
}
