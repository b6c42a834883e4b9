//! The joint problem of all equations → equations with evidence.
//!
//! In: a program, its data, the problem. Out: a [`Discovery`]. Does not decide whether to estimate jointly.

use std::borrow::Cow;

use sidc_data::{Dataset, InputValue};
use sidc_discover as discover;
use sidc_discover::identifiability::Rows;
use sidc_discover::trajectory::Problem;
use sidc_discover::{Description, Fitted, Refusal};
use sidc_progress::Observer;
use sidc_system::discovery::Discovery;

use super::constant_estimation;
use super::evidence::{self, Weighing};
use super::program::Program;
use super::rates;
use crate::options::Options;

/// Estimates all equations with their trajectory; also says how well they describe the readings, `None` if nothing was fitted.
///
/// # Errors
/// The readings contradict the constraints of the model.
pub(super) fn jointly(
    program: &Program,
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(Discovery, Option<Description>), Box<Refusal>> {
    let search = &options.search;
    let found = discover::discover_jointly(
        (&program.model, &program.libraries),
        (dataset, problem),
        search,
        observer,
    )?;
    let (mut discovery, fitted) = found.unwrap_or_else(|| {
        let nothing = discover::nothing_fits(&program.model, problem);
        (nothing, Fitted::default())
    });
    rates::doubt(&mut discovery, &dataset.rate_faults);
    constant_estimation::doubt(program, &fitted.samples, &mut discovery, options);
    let constants = discovery.constant_values();
    let dataset = &match constants.is_empty() {
        true => Cow::Borrowed(dataset),
        false => Cow::Owned(dataset.with_constants(&constants)),
    };
    let acting = discovery.without_delays(dataset, InputValue::AtInstant);
    let acting = acting.as_ref().unwrap_or(dataset);
    let read = evidence::readings(program, acting, &discovery);
    let weighing = Weighing {
        program,
        rows: Rows {
            samples: &fitted.samples,
            read: read.as_ref(),
            unread: &dataset.unread,
        },
        stretches: fitted.stretches.as_ref(),
        options: search,
    };
    weighing.weigh(&mut discovery, observer);
    Ok((discovery, fitted.description))
}
