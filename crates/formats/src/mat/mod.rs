//! MATLAB files: level 5, as `save` writes with `-v6` and `-v7` (its default), and Octave with the same options.
//!
//! In: bytes. Out: named arrays; the fields of a structure are arrays of their own. Source: MathWorks, "MAT-File Format", R2023b.

mod array;
mod element;

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::fault::Fault;
use crate::variables::{Content, Variable};
use array::{Array, Value};
use element::Element;

/// Text, version, order of bytes.
const HEADER: u64 = 128;

/// The variables of a file, in its order. A field `data.t` is called `t`, or `data_t` if two would have the same name.
///
/// # Errors
/// Damage; more memory than is left.
pub(crate) fn variables(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    let big_endian = matches!(bytes.get(126..128), Some(b"MI"));
    let mut all = Bytes::new(bytes, big_endian);
    all.take(HEADER)?;
    let mut found: Vec<Found> = Vec::new();
    while !all.is_empty() {
        let element = Element::read(&mut all)?;
        let content = match element.kind {
            element::COMPRESSED => {
                let inflated = flate2::bufread::ZlibDecoder::new(element.data);
                Cow::Owned(budget.unpack(inflated)?)
            }
            element::MATRIX => Cow::Borrowed(element.data),
            // The subsystem of objects, and what later versions may add.
            _ => continue,
        };
        let mut content = Bytes::new(&content, big_endian);
        if element.kind == element::COMPRESSED {
            let inner = Element::read(&mut content)?;
            if inner.kind != element::MATRIX {
                continue;
            }
            content = Bytes::new(inner.data, big_endian);
        }
        let array = Array::read(content, budget, 0)?;
        // The data of objects are stored in an array without a name.
        if !array.name.is_empty() {
            flatten(array, None, &mut found);
        }
    }
    Ok(named(found))
}

/// An array, its name and that of the structure that it is a field of.
pub(crate) struct Found {
    pub parent: Option<String>,
    pub name: String,
    pub content: Content,
}

/// An array, or each field of a structure and of those within it.
fn flatten(array: Array, parent: Option<&str>, out: &mut Vec<Found>) {
    let Array { name, value } = array;
    match value {
        Value::Column(content) => {
            let parent = parent.map(String::from);
            out.push(Found {
                parent,
                name,
                content,
            });
        }
        Value::Fields(fields) => {
            for field in fields {
                flatten(field, Some(&name), out);
            }
        }
    }
}

/// Arrays by their names, after that of their structure if another array has the same name.
pub(crate) fn named(found: Vec<Found>) -> Vec<Variable> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for array in &found {
        *counts.entry(array.name.clone()).or_default() += 1;
    }
    let twice = |name: &str| counts.get(name).is_some_and(|count| *count > 1);
    let names: Vec<String> = found
        .iter()
        .map(|f| match &f.parent {
            Some(parent) if twice(&f.name) => format!("{parent}_{}", f.name),
            _ => f.name.clone(),
        })
        .collect();
    let variables = names.into_iter().zip(found);
    variables
        .map(|(name, Found { content, .. })| Variable { name, content })
        .collect()
}
