//! `modelDescription.xml`: what an importer reads about an FMU, and `buildDescription.xml`: how it is compiled.
//!
//! In: the variables. Out: XML. Names that users chose are escaped here and nowhere else.

use std::collections::BTreeSet;

use super::token::TOKEN;
use super::variables::{Role, Variable, Variables};
use super::wrapper::has_directional_derivatives;
use crate::caveats::caveats;
use crate::code::program::Program;
use crate::typeset::mathml::escape;
use sidc_system::discovery::Discovery;

pub(super) fn text(d: &Discovery, program: &Program, variables: &Variables, id: &str) -> String {
    let events = !program.switches.is_empty();
    let name = program.system.as_deref().unwrap_or("identified");
    let about = caveats(d).join("\n");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription\n  fmiVersion=\"3.0\"\n  modelName=\"{}\"\n  \
         instantiationToken=\"{TOKEN}\"\n  description=\"Written by sidc&#10;{}\"\n  generationTool=\"sidc {}\"\n  \
         variableNamingConvention=\"flat\">\n  <ModelExchange\n    modelIdentifier=\"{id}\"\n    canGetAndSetFMUState=\"true\"\n    \
         canSerializeFMUState=\"true\"\n    providesDirectionalDerivatives=\"{}\"\n    needsCompletedIntegratorStep=\"{events}\"/>\n\
         {}  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n  <ModelVariables>\n{}  </ModelVariables>\n  \
         <ModelStructure>\n{}  </ModelStructure>\n</fmiModelDescription>\n",
        escape(name),
        attribute(&about),
        env!("CARGO_PKG_VERSION"),
        has_directional_derivatives(program),
        units(variables),
        declared(variables),
        structure(variables),
    )
}

/// What to compile: one file, which includes the other.
pub(super) fn build(id: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration modelIdentifier=\"{id}\">\n    \
         <SourceFileSet language=\"C99\">\n      <SourceFile name=\"fmi3.c\"/>\n    </SourceFileSet>\n  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
}

/// Text of several lines as the value of an attribute, where a plain line end would be read as a space.
fn attribute(text: &str) -> String {
    escape(text).replace('\n', "&#10;")
}

fn units(variables: &Variables) -> String {
    let all: BTreeSet<&String> = variables
        .all
        .iter()
        .filter_map(|v| v.unit.as_ref())
        .collect();
    let each = all
        .iter()
        .map(|u| format!("    <Unit name=\"{}\"/>\n", escape(u)));
    match all.is_empty() {
        true => String::new(),
        false => format!(
            "  <UnitDefinitions>\n{}  </UnitDefinitions>\n",
            each.collect::<String>()
        ),
    }
}

fn declared(variables: &Variables) -> String {
    let all = variables.all.iter().enumerate();
    all.map(|(reference, v)| variable(reference, v)).collect()
}

fn variable(reference: usize, v: &Variable) -> String {
    let start = format!(" start=\"{:?}\"", v.start);
    let role = match v.role {
        Role::Time => "causality=\"independent\" variability=\"continuous\"".to_string(),
        Role::State => {
            format!("causality=\"output\" variability=\"continuous\" initial=\"exact\"{start}")
        }
        Role::Rate(of) => format!(
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"{of}\""
        ),
        Role::Input => format!("causality=\"input\" variability=\"continuous\"{start}"),
        Role::Parameter => format!("causality=\"parameter\" variability=\"tunable\"{start}"),
        Role::Output => {
            "causality=\"output\" variability=\"continuous\" initial=\"calculated\"".into()
        }
        Role::Guard => {
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\"".into()
        }
    };
    let said = |name: &str, value: Option<&str>| {
        let value = value.filter(|v| !v.is_empty());
        value.map_or_else(String::new, |v| format!(" {name}=\"{}\"", attribute(v)))
    };
    format!(
        "    <Float64 name=\"{}\" valueReference=\"{reference}\" {role}{}{}/>\n",
        escape(&v.name),
        said("unit", v.unit.as_deref()),
        said("description", Some(&v.about)),
    )
}

/// Outputs list what they depend on, so that importers see where there is no direct feedthrough.
fn structure(variables: &Variables) -> String {
    let output = |r: Role| matches!(r, Role::State | Role::Output);
    let rate = |r: Role| matches!(r, Role::Rate(_));
    let mut out = String::new();
    let mut list = |element: &str, all: Vec<(usize, &Variable)>, follows: bool| {
        for (reference, v) in all {
            let known = v.follows.as_ref().filter(|_| follows);
            let known = known.map_or_else(String::new, |all| {
                let all: Vec<String> = all.iter().map(usize::to_string).collect();
                format!(" dependencies=\"{}\"", all.join(" "))
            });
            out.push_str(&format!(
                "    <{element} valueReference=\"{reference}\"{known}/>\n"
            ));
        }
    };
    list("Output", variables.of(output).collect(), true);
    list(
        "ContinuousStateDerivative",
        variables.of(rate).collect(),
        false,
    );
    let unknown = |r: Role| rate(r) || r == Role::Output;
    list("InitialUnknown", variables.of(unknown).collect(), false);
    list(
        "EventIndicator",
        variables.of(|r| r == Role::Guard).collect(),
        false,
    );
    out
}
