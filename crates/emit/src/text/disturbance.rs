//! What drives the equations besides their terms, as sentences.
//!
//! In: a discovery. Out: a sentence for each equation that has a disturbance.

use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::{Discovery, Equation};

/// `white noise drives dx too: in 1 s it moves x by 0.5 (standard deviation)`
pub(crate) fn sentences(d: &Discovery) -> impl Iterator<Item = String> {
    d.equations.iter().filter_map(|e| sentence(d, e))
}

fn sentence(d: &Discovery, e: &Equation) -> Option<String> {
    let together = e.evidence.as_ref()?.joint.as_ref()?;
    let found = together.disturbance.as_ref().filter(|d| d.size > 0.0)?;
    let (target, size) = (d.name(e.target), significant(found.size, 3));
    Some(match found.memory {
        None => {
            let below = Signal::derivative(e.target.var, e.target.der.saturating_sub(1));
            format!(
                "white noise drives {target} too: in {} it moves {} by {size} (standard deviation)",
                d.duration(1.0),
                d.name(below)
            )
        }
        Some(memory) => format!(
            "a disturbance drives {target} too: {size} (standard deviation), for {} at a time",
            d.duration(memory)
        ),
    })
}
