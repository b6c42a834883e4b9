//! From definitions and results to the statements of one function.
//!
//! In: the arguments of the function, what defines the unknowns, the expressions to compute. Out: a [`Body`]: scheduled steps, the
//! entries of arguments that are read, and the preferred name of each named value. Knows no language.

use std::collections::BTreeSet;

use crate::code::program::definitions::Definitions;
use crate::code::program::schedule::schedule;
use crate::code::program::statements::{Argument, Body, Name, Read, Step};
use sidc_lang::term::{Expr, Node, Signal};

/// The signals that a function can use.
pub(crate) struct Scope<'a> {
    pub arguments: &'a [&'a Argument],
    /// Every signal that an argument or an equation gives, with its name.
    pub names: &'a [(Signal, String)],
    /// Unknown constants, the only signals that exponents may contain.
    pub constants: &'a [Signal],
}

impl Scope<'_> {
    /// # Errors
    /// A signal in the expressions that is neither argument nor unknown.
    pub fn lower(&self, definitions: Definitions, results: Vec<Vec<Expr>>) -> Result<Body, Signal> {
        let mut inputs = vec![Signal::TIME];
        inputs.extend(self.names.iter().map(|(s, _)| *s));
        inputs.extend(definitions.derivatives.iter().map(|(s, ..)| *s));
        let given = (inputs, self.constants);
        let mut body = schedule(definitions.in_order, &results, given)?;
        body.reads = self.reads(&body);
        body.preferred_names = self.preferred_names(&body, &definitions.derivatives);
        Ok(body)
    }

    fn reads(&self, body: &Body) -> Vec<Read> {
        let mentioned: BTreeSet<Signal> = body
            .nodes()
            .iter()
            .filter_map(|n| match n {
                Node::Input(row) => Some(body.input(*row)),
                _ => None,
            })
            .collect();
        let entries = self.arguments.iter().flat_map(|a| {
            a.signals.iter().enumerate().map(move |(place, s)| Read {
                argument: a.name,
                place,
                signal: *s,
            })
        });
        entries.filter(|r| mentioned.contains(&r.signal)).collect()
    }

    /// `sin_theta` for a function of one signal, `ddx_by_x` for a derivative, else `w1`, `w2`, …
    fn preferred_names(
        &self,
        body: &Body,
        derivatives: &[(Signal, Signal, Signal)],
    ) -> Vec<(Name, String)> {
        let name = |s: Signal| {
            let found = self.names.iter().find(|(known, _)| *known == s);
            found.map_or_else(|| "t".to_string(), |(_, n)| n.clone())
        };
        let derivatives = derivatives
            .iter()
            .map(|(s, of, by)| (Name::Signal(*s), format!("{}_by_{}", name(*of), name(*by))));
        let mut preferred_names: Vec<(Name, String)> = derivatives.collect();
        let mut count = 0;
        let mut named = BTreeSet::new();
        for node in body.steps.iter().flat_map(Step::named) {
            if !named.insert(node) {
                continue;
            }
            let preferred = word(body, node, &name).unwrap_or_else(|| {
                count += 1;
                format!("w{count}")
            });
            preferred_names.push((Name::Node(node), preferred));
        }
        preferred_names
    }
}

/// `sin_theta` for a function of one signal.
fn word(body: &Body, node: usize, name: &impl Fn(Signal) -> String) -> Option<String> {
    let Node::Call(f, args) = body.nodes().get(node)? else {
        return None;
    };
    match (
        args.as_slice(),
        args.first().and_then(|a| body.nodes().get(*a)),
    ) {
        ([_], Some(Node::Input(row))) => Some(format!("{}_{}", f.name, name(body.input(*row)))),
        _ => None,
    }
}
