//! The layout of a message: the formats that a log declares, with nested formats expanded.

use std::collections::BTreeMap;

use crate::budget::Budget;
use crate::bytes::Number;
use crate::fault::Fault;

/// Formats by their names.
#[derive(Default)]
pub(super) struct Formats {
    by_name: BTreeMap<String, Vec<Part>>,
}

/// A field as it is declared: `float[4] q`.
struct Part {
    kind: String,
    /// `None` for a field that is no array.
    count: Option<usize>,
    name: String,
}

/// Where the numbers of a message are.
#[derive(Default)]
pub(super) struct Layout {
    pub fields: Vec<Field>,
    /// Offset of the time, microseconds in eight bytes.
    pub time: usize,
    /// Bytes of a message without the padding at its end.
    pub length: usize,
    /// Names of fields that are text.
    pub texts: Vec<String>,
}

pub(super) struct Field {
    pub name: String,
    pub offset: usize,
    pub number: Number,
}

/// Most bytes of a message, whose length is stored in two bytes.
const MOST_BYTES: usize = 1 << 16;

/// Deepest nesting of formats.
const MAX_DEPTH: usize = 16;

const TIME: &str = "timestamp";

/// The state of a layout in the making.
struct Cursor {
    layout: Layout,
    offset: usize,
    time: Option<usize>,
    /// Fields and formats that may still be laid out; without this limit, those of no bytes could go on for ever.
    left: usize,
}

impl Formats {
    /// Adds a format: `name:type field;type[n] field;…`.
    ///
    /// # Errors
    /// Another syntax; more memory than is left.
    pub(super) fn add(&mut self, content: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        budget.take(content.len() as u64, 32)?;
        let text = String::from_utf8_lossy(content);
        let unreadable = || Fault::damaged("a format that cannot be read");
        let (name, fields) = text.split_once(':').ok_or_else(unreadable)?;
        let fields = fields.split(';').filter(|field| !field.trim().is_empty());
        let parts: Option<Vec<Part>> = fields.map(Part::read).collect();
        let parts = parts.ok_or_else(unreadable)?;
        self.by_name.insert(name.trim().to_string(), parts);
        Ok(())
    }

    /// # Errors
    /// An unknown format or type, no time, longer than a message can be.
    pub(super) fn layout(&self, topic: &str, budget: &mut Budget) -> Result<Layout, Fault> {
        let mut cursor = Cursor {
            layout: Layout::default(),
            offset: 0,
            time: None,
            left: MOST_BYTES,
        };
        self.lay_out(topic, "", 0, &mut cursor)?;
        let Cursor { layout, time, .. } = cursor;
        let time = time.ok_or_else(|| Fault::damaged("its messages have no timestamp"))?;
        let length = layout.length.max(time + 8);
        budget.take(layout.fields.len() as u64, 128)?;
        Ok(Layout {
            time,
            length,
            ..layout
        })
    }

    fn lay_out(
        &self,
        format: &str,
        inside: &str,
        depth: usize,
        cursor: &mut Cursor,
    ) -> Result<(), Fault> {
        let parts = self.by_name.get(format).filter(|_| depth <= MAX_DEPTH);
        let Some(parts) = parts else {
            return Err(Fault::damaged(format!("the format {format} is unknown")));
        };
        for part in parts {
            let name = match inside {
                "" => part.name.clone(),
                inside => format!("{inside}_{}", part.name),
            };
            if part.kind == "char" {
                cursor.pass(part.count.unwrap_or(1))?;
                cursor.layout.texts.push(name);
                continue;
            }
            if part.name.starts_with("_padding") {
                let size = number(&part.kind).map_or(1, Number::size);
                // Padding at the end of a message is not logged.
                let logged = cursor.layout.length;
                cursor.pass(part.count.unwrap_or(1).saturating_mul(size))?;
                cursor.layout.length = logged;
                continue;
            }
            for place in 0..part.count.unwrap_or(1) {
                let name = match part.count {
                    Some(_) => format!("{name}_{place}"),
                    None => name.clone(),
                };
                match number(&part.kind) {
                    Some(number) => cursor.field(name, number)?,
                    None => {
                        cursor.pass(0)?;
                        self.lay_out(&part.kind, &name, depth + 1, cursor)?;
                    }
                }
            }
        }
        Ok(())
    }
}

impl Cursor {
    /// Advances by `size` bytes.
    fn pass(&mut self, size: usize) -> Result<(), Fault> {
        let end = self.offset.saturating_add(size);
        let left = self.left.checked_sub(1).filter(|_| end <= MOST_BYTES);
        let Some(left) = left else {
            return Err(Fault::damaged("its format is longer than a message can be"));
        };
        (self.offset, self.left) = (end, left);
        self.layout.length = end;
        Ok(())
    }

    fn field(&mut self, name: String, number: Number) -> Result<(), Fault> {
        let offset = self.offset;
        self.pass(number.size())?;
        match name == TIME && number == Number::Unsigned(8) {
            true => self.time = Some(offset),
            false => self.layout.fields.push(Field {
                name,
                offset,
                number,
            }),
        }
        Ok(())
    }
}

impl Part {
    fn read(text: &str) -> Option<Part> {
        let (kind, name) = text.trim().split_once(' ')?;
        let (kind, count) = match kind.split_once('[') {
            None => (kind, None),
            Some((kind, count)) => {
                let count = count.strip_suffix(']')?.parse().ok()?;
                (kind, Some(count))
            }
        };
        Some(Part {
            kind: kind.to_string(),
            count,
            name: name.trim().to_string(),
        })
    }
}

/// The number type of this name; `None` for the name of a format.
fn number(kind: &str) -> Option<Number> {
    Some(match kind {
        "int8_t" => Number::Signed(1),
        "uint8_t" | "bool" => Number::Unsigned(1),
        "int16_t" => Number::Signed(2),
        "uint16_t" => Number::Unsigned(2),
        "int32_t" => Number::Signed(4),
        "uint32_t" => Number::Unsigned(4),
        "int64_t" => Number::Signed(8),
        "uint64_t" => Number::Unsigned(8),
        "float" => Number::Single,
        "double" => Number::Double,
        _ => return None,
    })
}
