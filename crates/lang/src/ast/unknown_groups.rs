//! The constants of one `unknown` statement, group by group.
//!
//! In: names, a range, attributes as they were parsed. Out: which names share which range and attributes. Judges none of them.

use crate::ast::{Attribute, Expr, ExprKind, Ident};

/// Unknown constants that share a range and attributes.
#[derive(Clone, Debug)]
pub struct UnknownGroup<'a> {
    pub names: Vec<&'a Ident>,
    pub range: Option<&'a Expr>,
    pub attributes: &'a [Attribute],
}

/// The groups of `unknown a, b in 0..1, unit "m", c, d in 1..2`: here {a, b} with a unit, and {c, d}.
pub fn unknown_groups<'a>(
    names: &'a [Ident],
    range: Option<&'a Expr>,
    attributes: &'a [Attribute],
) -> Vec<UnknownGroup<'a>> {
    let is_range =
        |a: &&Attribute| matches!(&a.value, Some(e) if matches!(e.kind, ExprKind::Range(..)));
    let mut groups = vec![UnknownGroup {
        names: names.iter().collect(),
        range,
        attributes: &[],
    }];
    let mut rest = attributes;
    while let Some(ranged) = rest.iter().position(|a| is_range(&a)) {
        // Names without a range of their own share the next one.
        let bare = rest[..ranged]
            .iter()
            .rev()
            .take_while(|a| a.value.is_none());
        let first = ranged - bare.count();
        if let Some(group) = groups.last_mut() {
            group.attributes = &rest[..first];
        }
        groups.push(UnknownGroup {
            names: rest[first..=ranged].iter().map(|a| &a.key).collect(),
            range: rest[ranged].value.as_ref(),
            attributes: &[],
        });
        rest = &rest[ranged + 1..];
    }
    if let Some(group) = groups.last_mut() {
        group.attributes = rest;
    }
    groups
}
