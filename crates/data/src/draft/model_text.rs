//! The text of a first model, with comments that teach.
//!
//! In: columns, roles, states. Out: text in the language. Guesses nothing.

use std::collections::BTreeSet;

use super::candidate_terms::CandidateTerms;
use super::parts::Parts;
use super::states::derivative;
use super::table_column::Column;
use sidc_lang::source::printable;
use sidc_lang::units;

pub(super) fn model_text(p: &Parts) -> String {
    let mut out = String::from("sidc 1\n");
    let file = comment(p.table);
    out.push_str(&format!("# A first model of {file}, guessed from headers and from the shape of its columns: change it.\n"));
    out.push_str("# `sidc check` says what it means, `sidc identify` looks for its equations.\n\n");
    out.push_str(&declarations(p));
    out.push_str(&data(p));
    out.push_str(&equations(p));
    out
}

/// Text that neither ends a comment nor reverses its direction.
fn comment(text: &str) -> String {
    printable(text).replace(['\n', '\t'], " ")
}

fn declarations(p: &Parts) -> String {
    let mut out = String::new();
    match p.is_discrete() {
        true => out.push_str("# States: what evolves.\n"),
        false => out.push_str("# States: what evolves. With `order 2` the acceleration is sought, with `order 1` the rate.\n"),
    }
    for s in p.states {
        let mut attributes = Vec::new();
        if !p.is_discrete() {
            attributes.push(format!("order {}", s.order));
        }
        match s.angle {
            Some(_) => attributes.push("unit \"rad\"".into()),
            None => attributes.extend(unit(s.column)),
        }
        let why = (!p.is_discrete()).then_some(s.why);
        out.push_str(&declared("state", &s.name, &attributes, why));
    }
    if !p.roles.inputs.is_empty() {
        out.push_str("\n# Inputs: what acts from outside. `hold` keeps the last sample, `linear` joins samples.\n");
    }
    for (i, held) in &p.roles.inputs {
        let Some(column) = p.all.get(*i) else {
            continue;
        };
        let mut attributes = Vec::new();
        if !p.is_discrete() {
            attributes.push(if *held { "hold" } else { "linear" }.to_string());
        }
        attributes.extend(unit(column));
        let why = p.roles.why.get(i).copied();
        out.push_str(&declared("input", &column.declared(), &attributes, why));
    }
    let params: Vec<&Column> = p
        .roles
        .params
        .iter()
        .filter_map(|i| p.all.get(*i))
        .collect();
    if !params.is_empty() {
        out.push_str("\n# Constant along a run, different between runs.\n");
    }
    for column in params {
        let attributes: Vec<String> = unit(column).into_iter().collect();
        out.push_str(&declared("param", &column.declared(), &attributes, None));
    }
    out.push('\n');
    out
}

fn declared(kind: &str, name: &str, attributes: &[String], why: Option<&str>) -> String {
    let why = reason(why);
    match attributes.is_empty() {
        true => format!("{kind} {name}{why}\n"),
        false => format!("{kind} {name} : {}{why}\n", attributes.join(", ")),
    }
}

/// A comment behind what was guessed.
fn reason(why: Option<&str>) -> String {
    why.map(|why| format!("  # {why}")).unwrap_or_default()
}

/// `unit "mm"`, if the header has one that the language knows.
fn unit(c: &Column) -> Option<String> {
    let unit = c.unit.as_deref()?;
    let plain = !unit.is_empty()
        && !unit
            .chars()
            .any(|c| c == '"' || c == '\\' || c.is_control());
    (plain && units::parse(unit).is_ok()).then(|| format!("unit \"{unit}\""))
}

fn data(p: &Parts) -> String {
    let mut out = String::from(
        "# Where each signal is; arithmetic on headers converts: \"Pos [mm]\" * 1e-3\ndata {\n",
    );
    let why = |column: Option<usize>| column.and_then(|c| p.roles.why.get(&c)).copied();
    if let Some(time) = p.roles.time.and_then(|t| p.all.get(t)) {
        let unit = time.unit.as_deref().unwrap_or("");
        let factor = times(time.seconds().unwrap_or_default());
        let unknown = match (factor.is_empty(), unit) {
            (true, "" | "s") => None,
            (true, _) => Some("time is taken for seconds"),
            _ => None,
        };
        let why = reason(unknown.or(why(p.roles.time)));
        out.push_str(&format!("  t = \"{}\"{factor}{why}\n", time.header));
    }
    if let Some(run) = p.roles.run.and_then(|r| p.all.get(r)) {
        let why = reason(why(p.roles.run));
        out.push_str(&format!("  run = \"{}\"{why}\n", run.header));
    }
    for s in p.states {
        let factor = match s.angle {
            Some(a) if a.degrees => " * pi/180",
            _ => "",
        };
        let header = &s.column.header;
        let from = match s.angle {
            Some(a) if a.wraps && a.degrees => format!("unwrap(\"{header}\", 360){factor}"),
            Some(a) if a.wraps => format!("unwrap(\"{header}\", 2*pi)"),
            _ => format!("\"{header}\"{factor}"),
        };
        out.push_str(&format!("  {} = {from}\n", s.name));
        for (column, rate) in s.rates.iter().filter(|(_, rate)| rate.order <= s.order) {
            let name = derivative(&s.name, rate.order);
            if p.is_discrete() {
                let header = comment(&column.header);
                out.push_str(&format!(
                    "  # \"{header}\" seems to be {name}, which a law from sample to sample has not.\n"
                ));
                continue;
            }
            let factor = times(rate.factor.unwrap_or_else(|| by_unit(column)));
            let why = reason(rate.factor.map(|_| "the slope, by its values"));
            out.push_str(&format!("  {name} = \"{}\"{factor}{why}\n", column.header));
        }
    }
    let others = p.roles.inputs.iter().map(|(i, _)| i).chain(&p.roles.params);
    for column in others.filter_map(|i| p.all.get(*i)) {
        out.push_str(&format!(
            "  {} = \"{}\"\n",
            column.declared(),
            column.header
        ));
    }
    out.push_str("}\n");
    let still = p.roles.still.iter().filter_map(|i| p.all.get(*i));
    for column in still {
        out.push_str(&format!(
            "# \"{}\" never moves, and is left out.\n",
            comment(&column.header)
        ));
    }
    let combinations = p.roles.combinations.iter().filter_map(|i| p.all.get(*i));
    for column in combinations {
        out.push_str(&format!(
            "# Left out: \"{}\" is a sum of multiples of other columns.\n",
            comment(&column.header)
        ));
    }
    for why in p.left_out {
        out.push_str(&format!("# Left out: {}.\n", comment(why)));
    }
    if p.is_discrete() {
        out.push_str("# No column is time, so this is a law from sample to sample. Of a motion say `step 0.01` (seconds)\n# in the data block, give the states an order, and ask for dx instead of next x.\n");
    }
    out + "\n"
}

/// The factor of a rate of an angle to radians, by its unit alone.
fn by_unit(rate: &Column) -> &'static str {
    let degrees = rate.unit_is(&["deg/s", "°/s", "deg/s^2", "°/s²"]);
    let rpm = rate.unit_is(&["rpm", "1/min"]);
    match (degrees, rpm) {
        (true, _) => "pi/180",
        (_, true) => "2*pi/60",
        _ => "",
    }
}

fn times(factor: &str) -> String {
    match factor {
        "" => String::new(),
        f => format!(" * {f}"),
    }
}

fn equations(p: &Parts) -> String {
    let candidates = CandidateTerms::of(p);
    let targets: BTreeSet<String> = (p.states.iter())
        .map(|s| match p.is_discrete() {
            true => format!("next {}", s.name),
            false => derivative(&s.name, s.order),
        })
        .collect();
    let mut out = String::from("# Candidate terms: products of signals up to a degree");
    if !candidates.trigonometric.is_empty() {
        out.push_str(", times sines and cosines of the angles");
    }
    out.push_str(".\n# Add what you suspect, such as + <x*abs(x), exp(-x), x/(1 + x)> with names of your own.\n");
    if candidates.are_coupled() {
        out.push_str("# The accelerations of the others are among them: a body that turns acts on the others by these.\n");
    }
    for target in targets {
        let right = candidates.right_side(&target);
        out.push_str(&format!("{target} ~ {right}\n"));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_stays_on_its_line_and_in_its_direction() {
        assert_eq!(
            comment("a\nstate b\tc\rd\u{1b}[2J\u{202e}e"),
            "a state b c d?[2J\u{fffd}e"
        );
    }
}
