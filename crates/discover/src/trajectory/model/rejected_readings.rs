//! Readings that get no weight because a smooth curve through the others does not explain them.
//!
//! In: records. Out: the same with those readings missing, and a list of them. Sees no laws.

use super::record::Record;
use sidc_data as data;
use sidc_lang::sensor_noise::SensorNoise;

/// A reading without weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    pub record: usize,
    pub state: usize,
    pub sample: usize,
    pub value: f64,
}

/// Takes outliers of the robust smoother out of the records.
pub(crate) fn reject_outliers(
    records: &mut [Record],
    declared: &[Option<SensorNoise>],
) -> Vec<LeftOut> {
    let mut out = Vec::new();
    for (r, record) in records.iter_mut().enumerate() {
        let time = &record.time;
        for (state, column) in record.measured.iter_mut().enumerate() {
            let sigma = declared[state].map(|noise| noise.rms(column.iter()));
            let Some(smooth) = data::smooth(time, column, sigma, &[], true) else {
                continue;
            };
            for sample in smooth.outliers {
                out.push(LeftOut {
                    record: r,
                    state,
                    sample,
                    value: std::mem::replace(&mut column[sample], f64::NAN),
                });
            }
        }
    }
    out
}
