//! Predictions with the equations found, along other data.

use sidc_data::Dataset;
use sidc_progress::Observer;
use sidc_system::predict::{self, Prediction, PredictionRequest};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::Error;

impl Discovery {
    /// How well the equations predict these data `horizon` seconds (samples in discrete time) ahead, from states fitted to the readings before each start;
    /// without a horizon the data decide. The linear model for comparison is fitted to the same data.
    ///
    /// Equations that cannot predict are not an error: see [`Prediction::unavailable`](Prediction).
    ///
    /// # Errors
    /// [`ErrorKind::Data`](crate::ErrorKind): arrays missing that a run needs.
    pub fn predict(
        &self,
        data: &Data,
        horizon: Option<f64>,
        observer: &mut dyn Observer,
    ) -> Result<Prediction, Error> {
        let records = self.records(data, &[])?;
        let source = records.source();
        let request = PredictionRequest {
            horizon,
            good: Vec::new(),
        };
        Ok(predict::predict(
            (source.discovery, source.model),
            (source.dataset, &Dataset::default()),
            &request,
            observer,
        ))
    }
}
