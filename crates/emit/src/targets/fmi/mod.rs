//! FMI 3.0: a functional mock-up unit for Model Exchange as C sources, for Simulink, Dymola, OpenModelica, fmpy and the like.
//!
//! In: a discovery in continuous time. Out: a zip archive of `modelDescription.xml` and `sources`. The importer compiles the binary with
//! the FMI headers. The equations are those of target `c`.

mod archive;
mod model_description;
mod token;
mod variables;
mod wrapper;

use crate::code::c_sources::C;
use crate::code::equation_list::check_continuous;
use crate::code::identifiers::ascii;
use crate::code::program::Program;
use crate::target::{Target, Written};
use sidc_system::discovery::Discovery;
use token::{TOKEN, token};
use variables::Variables;

pub(crate) struct Fmi;

impl Target for Fmi {
    fn name(&self) -> &'static str {
        "fmi"
    }

    fn about(&self) -> &'static str {
        "an FMU of FMI 3.0 for Model Exchange, as C sources: a binary file, -o R.fmu"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        check_continuous("FMI", &program)?;
        let equations = C::<false>.emit(d)?.into_bytes();
        let variables = Variables::new(d, &program);
        let id = ascii(program.system.as_deref().unwrap_or("identified"));
        let description = model_description::text(d, &program, &variables, &id);
        let wrapper = wrapper::text(&program, &variables);
        let token = token(&[&equations, description.as_bytes(), wrapper.as_bytes()]);
        let bytes = archive::zip(&[
            (
                "modelDescription.xml",
                description.replace(TOKEN, &token).as_bytes(),
            ),
            (
                "sources/buildDescription.xml",
                model_description::build(&id).as_bytes(),
            ),
            ("sources/equations.c", &equations),
            ("sources/fmi3.c", wrapper.replace(TOKEN, &token).as_bytes()),
        ])?;
        Ok(Written::Binary {
            bytes,
            suffix: "fmu",
        })
    }
}
