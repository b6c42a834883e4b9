//! Noise of sensors that lasts from sample to sample: an autoregression of first order in continuous time, as behind a filter.
//!
//! In: a problem, the memory of each state's sensors. Out: the problem whose likelihood is that of the part of each error that is new, which
//! is white (Prais & Winsten 1954): with ρ = exp(−h/τ), e_k − ρ e_{k−1} has the variance (1 − ρ²) σ². Estimates nothing.

use super::estimation_problem::Problem;
use sidc_lang::term::Signal;

impl Problem {
    /// The problem with the time constants of sensors' noise that the model declares.
    pub fn with_declared_memory(&self, declared: &dyn Fn(Signal) -> Option<f64>) -> Problem {
        let declared: Vec<Option<f64>> = self.system.states.iter().map(|s| declared(*s)).collect();
        let memory: Vec<f64> = declared.iter().map(|m| m.unwrap_or(0.0)).collect();
        let mut problem = match declared.iter().any(Option::is_some) {
            true => self.with_noise_memory(&memory),
            false => self.clone(),
        };
        problem.declared_memory = declared;
        problem
    }

    /// The same readings with noise of these time constants (s), one a state; 0 for white noise.
    pub(crate) fn with_noise_memory(&self, memory: &[f64]) -> Problem {
        let mut problem = self.clone();
        for record in &mut problem.records {
            record.noise_time_constant = memory.to_vec();
        }
        problem.count();
        problem
    }

    /// Time constant (s) of the noise of a state's sensors, where it lasts.
    pub(crate) fn noise_time_constant(&self, state: usize) -> Option<f64> {
        let memory = self.records.first()?.noise_time_constant.get(state)?;
        Some(*memory).filter(|m| *m > 0.0)
    }

    /// Whether the model declares that the noise of some sensor lasts.
    pub(crate) fn declares_memory(&self) -> bool {
        self.declared_memory.iter().flatten().any(|m| *m > 0.0)
    }

    /// Number of time constants that are not declared.
    pub(crate) fn estimated_memories(&self) -> usize {
        let own = |i: &usize| {
            self.noise_time_constant(*i).is_some() && self.declared_memory[*i].is_none()
        };
        (0..self.states()).filter(own).count()
    }

    /// Σ ln(1 − ρ²) over the readings of every sensor.
    pub(super) fn log_new_variances(&self) -> Vec<f64> {
        let mut all = vec![0.0; self.sensors.count()];
        for (r, record) in self.records.iter().enumerate() {
            let own = &mut all[self.sensors.of(r)];
            for (state, sum) in own.iter_mut().enumerate() {
                if self.noise_time_constant(state).is_some() {
                    let lasting = (0..record.len()).map(|k| record.lasting_at(state, k));
                    *sum += lasting.map(|l| (-l * l).ln_1p()).sum::<f64>();
                }
            }
        }
        all
    }
}
