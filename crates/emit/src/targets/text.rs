//! Plain text: the equations and what follows from them, as the terminal shows them.

use crate::caveats::caveats;
use crate::code::printer::commented;
use crate::target::{Target, Written};
use crate::text::equations::equations;
use crate::text::matrices::derived_forms;
use crate::unknown_constants;
use sidc_system::discovery::Discovery;

pub(crate) struct Text;

impl Target for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn about(&self) -> &'static str {
        "equations and their matrices as the terminal shows them, six significant digits"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let caveats = commented("# ", caveats(d).into_iter());
        let jumps = d.resets.iter().map(|r| r.text(d));
        let constants = commented("", jumps.chain(unknown_constants::lines(d)));
        Ok((caveats + &equations(d).concat() + &constants + &derived_forms(d)).into())
    }
}
