//! How large a library is, in words.
//!
//! In: a library. Out: its number of terms and the memory that its dictionary Φ takes, as `sidc check` and editors show them.

use crate::library::block::Block;
use crate::library::candidates::Library;
use crate::library::readable::{readable, readable_bytes};
use crate::library::sets::selection_rule::restrictions;
use crate::model::Model;

/// `3,281 candidate terms of 6,561 (symmetry y, theta, F; degree ≤ 4)`
pub fn size(model: &Model, library: &Library) -> String {
    let name = if library.len() == 1 { "term" } else { "terms" };
    let mut text = format!("{} candidate {name}", readable(library.len() as u128));
    if let Some(by) = restrictions(model) {
        if let Some(before) = library.before() {
            text.push_str(&format!(" of {}", readable(before)));
        }
        text.push_str(&format!(" ({by})"));
    }
    if !library.required().is_empty() {
        text.push_str(&format!(", {} required", library.required().len()));
    }
    text
}

/// `stored as 81 × 81 products: Φ takes 130 kB per 100 rows, and 52 kB`
pub fn storage(library: &Library) -> String {
    let bytes = |n: usize| readable_bytes(8 * n as u128);
    let (lists, products): (Vec<&Block>, Vec<&Block>) =
        library.blocks().iter().partition(|b| b.is_list());
    let listed: usize = lists.iter().map(|b| b.slots()).sum();
    if products.is_empty() {
        return format!("Φ takes {} per 100 rows", bytes(100 * listed));
    }
    let sides = |b: &&Block| (b.left.len(), b.right.len());
    let mut parts: Vec<String> = match products.len() {
        1..=3 => products
            .iter()
            .map(sides)
            .map(|(l, r)| format!("{} × {}", readable(l as u128), readable(r as u128)))
            .collect(),
        n => vec![readable(n as u128)],
    };
    if listed > 0 {
        parts.insert(0, format!("{} listed", readable(listed as u128)));
    }
    let factors: usize = products.iter().map(sides).map(|(l, r)| l + r).sum();
    format!(
        "stored as {} products: Φ takes {} per 100 rows, and {}",
        parts.join(" + "),
        bytes(100 * (listed + factors)),
        bytes(library.slots())
    )
}
