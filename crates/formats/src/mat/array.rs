//! A MATLAB array: numbers, texts, or a structure of other arrays.

use super::element::{Element, MATRIX};
use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::fault::Fault;
use crate::variables::Content;
use sidc_data::Words;

#[derive(Debug)]
pub(super) struct Array {
    pub name: String,
    pub value: Value,
}

#[derive(Debug)]
pub(super) enum Value {
    Column(Content),
    /// The fields of a single structure.
    Fields(Vec<Array>),
}

/// Deepest nesting of structures and cells that is read.
const MAX_DEPTH: usize = 16;

/// The header of an array.
struct Head {
    class: u32,
    is_complex: bool,
    shape: Vec<usize>,
    /// Product of the sides.
    count: u64,
}

impl Array {
    /// # Errors
    /// Damage; more memory than is left.
    pub(super) fn read(mut from: Bytes, budget: &mut Budget, depth: usize) -> Result<Array, Fault> {
        let other = |what: &str| Value::Column(Content::Other(what.into()));
        if from.is_empty() {
            // An empty field.
            let name = String::new();
            return Ok(Array {
                name,
                value: other("empty"),
            });
        }
        let head = Head::read(&mut from)?;
        let Some(head) = head else {
            // Objects have their name in the next element.
            let name = Element::read(&mut from)?.name();
            let value = other("an object of MATLAB; save its columns as arrays");
            return Ok(Array { name, value });
        };
        let name = Element::read(&mut from)?.name();
        let within = |fault: Fault| fault.within(&name);
        let value = if depth > MAX_DEPTH {
            other("nested too deeply")
        } else {
            match head.class {
                1 => cells(from, &head, budget, depth).map_err(within)?,
                2 => fields(from, &head, budget, depth).map_err(within)?,
                4 => texts(from, &head, budget).map_err(within)?,
                6..=15 if head.is_complex => other("complex numbers"),
                6..=15 => numbers(from, head, budget).map_err(within)?,
                5 => other("a sparse matrix"),
                16 => other("a function"),
                _ => other("an object of MATLAB; save its columns as arrays"),
            }
        };
        Ok(Array { name, value })
    }
}

impl Head {
    /// `None` for objects, which have no shape.
    fn read(from: &mut Bytes) -> Result<Option<Head>, Fault> {
        let flags = Element::read(from)?;
        let mut words = Bytes::new(flags.data, flags.big_endian);
        let flags = words.u32()?;
        let class = flags & 0xff;
        if class == 17 {
            return Ok(None);
        }
        let sides = Element::read(from)?;
        if sides.count()? > 32 {
            return Err(Fault::damaged("an array of more than 32 dimensions"));
        }
        let mut shape = Vec::new();
        let mut count = 1u64;
        for side in sides.values()? {
            // The conversion saturates: a negative side has no values.
            let side = side as u64;
            count = count.saturating_mul(side);
            shape.push(side as usize);
        }
        let is_complex = flags & 0x0800 != 0;
        Ok(Some(Head {
            class,
            is_complex,
            shape,
            count,
        }))
    }
}

fn numbers(mut from: Bytes, head: Head, budget: &mut Budget) -> Result<Value, Fault> {
    if from.is_empty() && head.count == 0 {
        return Ok(Value::Column(Content::vector(Vec::new())));
    }
    let content = Element::read(&mut from)?;
    let there = content.count()?;
    if there as u64 != head.count {
        let count = head.count;
        let text = format!("{count} values are announced where {there} are left");
        return Err(Fault::damaged(text));
    }
    budget.take(head.count, 16)?;
    let values = content.values()?.collect();
    let shape = head.shape;
    Ok(Value::Column(Content::Numbers { shape, values }))
}

/// A text for each row of a matrix of characters; a single text is not a column.
fn texts(mut from: Bytes, head: &Head, budget: &mut Budget) -> Result<Value, Fault> {
    if head.count == 0 {
        return Ok(Value::Column(Content::Other("an empty text".into())));
    }
    let content = Element::read(&mut from)?;
    budget.take(content.data.len() as u64, 8)?;
    let rows = match head.shape.as_slice() {
        [rows, _] if *rows > 1 => *rows,
        _ => {
            let text = "one text".to_string();
            return Ok(Value::Column(Content::Other(text)));
        }
    };
    let characters = characters(&content)?;
    // Characters are stored column by column, as in all arrays.
    let line = |row: usize| {
        let text: String = characters.iter().skip(row).step_by(rows).collect();
        text.trim_end().to_string()
    };
    if rows > characters.len() {
        return Err(Fault::damaged("texts end before they should"));
    }
    Ok(Value::Column(Content::Words((0..rows).map(line).collect())))
}

fn characters(content: &Element) -> Result<Vec<char>, Fault> {
    use super::element::UTF16;
    Ok(match content.kind {
        16 => String::from_utf8_lossy(content.data).chars().collect(),
        4 | UTF16 => {
            let units = content.values()?.map(|v| v as u16);
            char::decode_utf16(units)
                .map(|c| c.unwrap_or('\u{fffd}'))
                .collect()
        }
        _ => {
            let codes = content.values()?.map(|v| v as u32);
            codes
                .map(|c| char::from_u32(c).unwrap_or('\u{fffd}'))
                .collect()
        }
    })
}

/// A cell array of texts is a column of them.
fn cells(mut from: Bytes, head: &Head, budget: &mut Budget, depth: usize) -> Result<Value, Fault> {
    let mut words = Words::default();
    // Each cell takes bytes of the file, so that a wrong count ends with the file.
    for _ in 0..head.count {
        let cell = Element::read(&mut from)?;
        let Some(word) = one_text(cell, budget, depth)? else {
            let text = "a cell array".to_string();
            return Ok(Value::Column(Content::Other(text)));
        };
        budget.take(word.len() as u64 + 4, 1)?;
        words.push(&word);
    }
    Ok(Value::Column(Content::Words(words)))
}

/// The text in a cell, if it holds one.
fn one_text(cell: Element, budget: &mut Budget, depth: usize) -> Result<Option<String>, Fault> {
    if cell.kind != MATRIX || depth > MAX_DEPTH {
        return Ok(None);
    }
    let mut from = Bytes::new(cell.data, cell.big_endian);
    if from.is_empty() {
        return Ok(Some(String::new()));
    }
    let Some(head) = Head::read(&mut from)? else {
        return Ok(None);
    };
    Element::read(&mut from)?;
    if head.class != 4 || head.shape.first().is_some_and(|rows| *rows > 1) {
        return Ok(None);
    }
    if from.is_empty() {
        return Ok(Some(String::new()));
    }
    let content = Element::read(&mut from)?;
    budget.take(content.data.len() as u64, 8)?;
    Ok(Some(characters(&content)?.into_iter().collect()))
}

/// The fields of a single structure; in an array of structures each field would be many arrays.
fn fields(mut from: Bytes, head: &Head, budget: &mut Budget, depth: usize) -> Result<Value, Fault> {
    if head.count != 1 {
        let text = format!("{} structures", head.count);
        return Ok(Value::Column(Content::Other(text)));
    }
    let length = Element::read(&mut from)?.values()?.next().unwrap_or(0.0) as usize;
    let names = Element::read(&mut from)?;
    let mut fields = Vec::new();
    for name in names.data.chunks_exact(length.max(1)) {
        let name = Element {
            data: name,
            ..names
        }
        .name();
        let content = Element::read(&mut from)?;
        let content = Bytes::new(content.data, content.big_endian);
        let array = Array::read(content, budget, depth + 1).map_err(|f| f.within(&name))?;
        fields.push(Array { name, ..array });
    }
    Ok(Value::Fields(fields))
}
