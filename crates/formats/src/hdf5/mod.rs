//! MATLAB's `-v7.3` files and other HDF5, read with the crate `hdf5-pure`.
//!
//! In: bytes. Out: named arrays of numbers; those of a group are named like the fields of a structure in an older MATLAB file. Texts,
//! cells, objects and complex numbers are not read.

use hdf5_pure::{AttrValue, DType, Dataset, Error, File, Group};

use crate::budget::Budget;
use crate::fault::Fault;
use crate::mat::{Found, named};
use crate::variables::{Content, Variable};

/// Deepest nesting of groups, and most members in total: a damaged group can contain itself.
const MAX_DEPTH: usize = 16;
const MAX_MEMBERS: usize = 100_000;

struct Walk<'a> {
    budget: &'a mut Budget,
    members: usize,
    found: Vec<Found>,
}

/// Every array of numbers in the file.
///
/// # Errors
/// Damage; more memory than is left.
pub(crate) fn variables(bytes: Vec<u8>, budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    // The crate is young. None of 313,000 changed files made it panic; this catches what those did not try.
    let read = std::panic::AssertUnwindSafe(|| arrays(bytes, budget));
    let panicked = |_| Err(Fault::damaged("it is no whole HDF5 file"));
    std::panic::catch_unwind(read).unwrap_or_else(panicked)
}

fn arrays(bytes: Vec<u8>, budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    let there = bytes.len() as u64;
    let file = File::from_bytes(bytes).map_err(damaged)?;
    // The crate reads a truncated file if the part that it needs is there.
    if file.superblock().eof_address > there {
        return Err(Fault::damaged("its end is missing"));
    }
    let mut walk = Walk {
        budget,
        members: 0,
        found: Vec::new(),
    };
    walk.group(&file.root(), None, 0)?;
    Ok(named(walk.found))
}

fn damaged(error: Error) -> Fault {
    Fault::damaged(format!("it is no whole HDF5 file ({error})"))
}

impl Walk<'_> {
    /// The arrays of a group, then those of the groups in it.
    fn group(&mut self, group: &Group, parent: Option<&str>, depth: usize) -> Result<(), Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::damaged("its groups are nested too deeply"));
        }
        let mut names = group.datasets().map_err(damaged)?;
        names.sort();
        for name in names {
            self.member(&name)?;
            let array = group.dataset(&name).map_err(damaged)?;
            let content = self.content(&array).map_err(|fault| fault.within(&name))?;
            let parent = parent.map(String::from);
            self.found.push(Found {
                parent,
                name,
                content,
            });
        }
        let mut names = group.groups().map_err(damaged)?;
        names.sort();
        // MATLAB keeps cells and objects in groups of such names.
        for name in names.iter().filter(|name| !name.starts_with('#')) {
            self.member(name)?;
            let inner = group.group(name).map_err(damaged)?;
            self.group(&inner, Some(name), depth + 1)?;
        }
        Ok(())
    }

    fn member(&mut self, name: &str) -> Result<(), Fault> {
        self.members += 1;
        if self.members > MAX_MEMBERS {
            return Err(Fault::damaged("it has too many arrays"));
        }
        self.budget.take(1, 200 + name.len() as u64)
    }

    fn content(&mut self, array: &Dataset) -> Result<Content, Fault> {
        let attributes = array.attrs().map_err(damaged)?;
        if attributes.contains_key("MATLAB_empty") {
            return Ok(Content::Other("empty".into()));
        }
        if let Some(other) = attributes.get("MATLAB_class").and_then(no_numbers) {
            return Ok(Content::Other(other));
        }
        let kind = array.dtype().map_err(damaged)?;
        if let Some(other) = skipped_layout(&kind) {
            return Ok(Content::Other(other.into()));
        }
        let shape = array.shape().map_err(damaged)?;
        self.budget.take(product(&shape), 16)?;
        // A chunk is unpacked whole, however little of it is in the array.
        let chunk = array.chunk_shape().map_err(damaged)?;
        let chunk = product(&chunk.unwrap_or_default()).saturating_mul(8);
        self.budget.take(chunk, 1)?;
        let values = array.read_f64().map_err(damaged)?;
        self.budget.give(chunk);
        // HDF5 has the last index fastest, MATLAB the first.
        let sides = shape.iter().rev().map(|side| *side as usize);
        let shape: Vec<usize> = sides.collect();
        if shape.iter().product::<usize>() != values.len() {
            return Err(Fault::damaged(
                "an array has another number of values than its shape",
            ));
        }
        Ok(Content::Numbers { shape, values })
    }
}

fn product(sides: &[u64]) -> u64 {
    sides.iter().fold(1, |all, side| all.saturating_mul(*side))
}

/// What a MATLAB array holds, if not numbers.
fn no_numbers(class: &AttrValue) -> Option<String> {
    let (AttrValue::AsciiString(class) | AttrValue::String(class)) = class else {
        return None;
    };
    let class = class.trim_end_matches('\0');
    let is_number = match class {
        "double" | "single" | "logical" => true,
        whole => whole.trim_start_matches('u').starts_with("int"),
    };
    match class {
        "char" => Some("text".into()),
        "cell" => Some("a cell array".into()),
        other => (!is_number).then(|| format!("an object of MATLAB, {other}")),
    }
}

fn skipped_layout(kind: &DType) -> Option<&'static str> {
    match kind {
        DType::F32 | DType::F64 | DType::I8 | DType::I16 | DType::I32 | DType::I64 => None,
        DType::U8 | DType::U16 | DType::U32 | DType::U64 | DType::Enum(_) => None,
        DType::Compound(parts) if parts.iter().any(|(name, _)| name == "imag") => {
            Some("complex numbers")
        }
        DType::String | DType::VariableLengthString => Some("text"),
        _ => Some("no numbers"),
    }
}
