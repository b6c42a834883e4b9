//! A start inside the domains of the terms.
//!
//! In: a problem whose smoothed trajectories may leave them, as a smooth curve through fast growth from near zero does. Out: the same with
//! those samples where the readings, or the nearest sample inside, put them. Drops no term.

use crate::trajectory::model::Problem;

impl Problem {
    /// The problem with smoothed trajectories along which every column has a value, where that takes no more than to follow the readings there,
    /// or a move by `within` standard deviations of their noise.
    pub fn with_defined_start(mut self, within: f64) -> Problem {
        for (r, undefined) in self.undefined_samples().into_iter().enumerate() {
            self.start_from_readings(r, &undefined);
        }
        for (r, undefined) in self.undefined_samples().into_iter().enumerate() {
            self.start_from_nearest(r, &undefined, within);
        }
        self
    }

    /// Of each record the samples at which some column has no value, rising.
    fn undefined_samples(&self) -> Vec<Vec<usize>> {
        let mut undefined = vec![Vec::new(); self.records.len()];
        for part in self.along_smoothed() {
            let is_undefined = |k: &usize| {
                let mut columns = part.values.iter().skip(*k).step_by(part.rows);
                columns.any(|x| !x.is_finite())
            };
            let own = (0..part.rows).filter(is_undefined);
            undefined[part.record].extend(own.map(|k| part.first + k));
        }
        undefined
    }

    fn start_from_readings(&mut self, r: usize, undefined: &[usize]) {
        let n = self.states();
        let (record, curve) = (&self.records[r], &mut self.smoothed[r]);
        for k in undefined {
            for (i, column) in record.measured.iter().enumerate() {
                if column[*k].is_finite() {
                    curve.states[k * n + i] = column[*k];
                }
            }
        }
    }

    fn start_from_nearest(&mut self, r: usize, undefined: &[usize], within: f64) {
        let n = self.states();
        let own = self.sensors.of(r);
        let (noise, readings) = (&self.noise[own.clone()], &self.readings[own]);
        let is_defined = |k: &usize| undefined.binary_search(k).is_err();
        let defined = (0..self.records[r].len()).filter(is_defined);
        let defined: Vec<usize> = defined.collect();
        for k in undefined {
            let at = defined.partition_point(|d| d < k);
            let around = at.checked_sub(1).into_iter().chain([at]);
            let around = around.filter_map(|place| defined.get(place));
            let Some(nearest) = around.min_by_key(|d| d.abs_diff(*k)) else {
                return;
            };
            let states = &mut self.smoothed[r].states;
            let is_near = |i: usize| {
                let move_to = states[nearest * n + i] - states[k * n + i];
                readings[i] == 0 || move_to.abs() <= within * noise[i]
            };
            if (0..n).all(is_near) {
                for i in (0..n).filter(|i| readings[*i] > 0) {
                    states[k * n + i] = states[nearest * n + i];
                }
            }
        }
    }
}
