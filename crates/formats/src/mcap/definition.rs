//! Definitions of ROS messages, as in `.msg` files.
//!
//! In: the text of a schema, which has the definitions of all its parts. Out: fields of numbers, texts and other definitions. Source: the
//! MCAP registry, "ros1msg" and "ros2msg"; the ROS wiki, "msg"; the ROS 2 documentation, "Interfaces".

use std::collections::BTreeMap;

use crate::bytes::Number;

/// The version of ROS, which decides the names of types and whether numbers are aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    Ros1,
    Ros2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number(Number),
    Text,
    /// Seconds and nanoseconds since 1970.
    Moment,
    /// Seconds and nanoseconds.
    Span,
    /// Another definition, by its place.
    Fields(usize),
    /// A byte without meaning: ROS 2 has no empty messages.
    Filler,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Length {
    One,
    /// An array.
    Fixed(usize),
    /// A list, with its length before it.
    Any,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    pub kind: Kind,
    pub length: Length,
}

/// Definitions that refer to each other by their places. Every field takes at least one byte, so that a message has no more fields than
/// bytes.
#[derive(Debug)]
pub(super) struct Definitions {
    pub dialect: Dialect,
    /// The place of the definition of the message.
    pub message: usize,
    pub all: Vec<Vec<Field>>,
}

/// Deepest nesting of definitions.
const MAX_DEPTH: usize = 16;

struct Parser<'a> {
    dialect: Dialect,
    /// The text of each definition, by name.
    texts: BTreeMap<String, &'a str>,
    /// Places by name.
    found: BTreeMap<String, usize>,
    all: Vec<Vec<Field>>,
}

impl Definitions {
    /// # Errors
    /// Why the messages cannot be read.
    pub(super) fn read(dialect: Dialect, name: &str, text: &str) -> Result<Definitions, String> {
        let mut texts = BTreeMap::new();
        // Before each definition but the first there are a line of equals signs and its name.
        for (place, part) in split(text).into_iter().enumerate() {
            if place == 0 {
                texts.insert(short(name), part);
            } else if let Some((head, body)) = part.trim_start().split_once('\n') {
                let own = head.trim().strip_prefix("MSG:").unwrap_or(head);
                texts.insert(short(own.trim()), body);
            }
        }
        let mut parser = Parser {
            dialect,
            texts,
            found: BTreeMap::new(),
            all: Vec::new(),
        };
        let message = parser.definition(&short(name), 0)?;
        Ok(Definitions {
            dialect,
            message,
            all: parser.all,
        })
    }
}

/// The definitions in a text.
fn split(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut start, mut at) = (0, 0);
    for line in text.split_inclusive('\n') {
        let bare = line.trim();
        if bare.len() > 3 && bare.bytes().all(|b| b == b'=') {
            parts.push(text.get(start..at).unwrap_or_default());
            start = at + line.len();
        }
        at += line.len();
    }
    parts.push(text.get(start..).unwrap_or_default());
    parts
}

/// `package/Type`, for `package/msg/Type` too.
fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

impl Parser<'_> {
    fn definition(&mut self, name: &str, depth: usize) -> Result<usize, String> {
        if let Some(place) = self.found.get(name) {
            return Ok(*place);
        }
        if depth > MAX_DEPTH {
            return Err("nested too deeply".into());
        }
        let Some(text) = self.texts.get(name).copied() else {
            return Err(format!("{name} is not defined"));
        };
        let package = name.rsplit_once('/').map_or("", |(package, _)| package);
        let mut fields = Vec::new();
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default();
            let mut words = line.split_whitespace();
            let (Some(kind), Some(name)) = (words.next(), words.next()) else {
                continue;
            };
            // `TYPE NAME=VALUE` is a constant.
            if name.contains('=') || words.next().is_some_and(|w| w.starts_with('=')) {
                continue;
            }
            fields.extend(self.field(kind, name, package, depth)?);
        }
        if fields.is_empty() && self.dialect == Dialect::Ros2 {
            fields.push(Field {
                name: String::new(),
                kind: Kind::Filler,
                length: Length::One,
            });
        }
        self.all.push(fields);
        let place = self.all.len() - 1;
        self.found.insert(name.to_string(), place);
        Ok(place)
    }

    /// `None` for a field that takes no bytes.
    fn field(
        &mut self,
        kind: &str,
        name: &str,
        package: &str,
        depth: usize,
    ) -> Result<Option<Field>, String> {
        let unreadable = || format!("{kind} is no type");
        let (bare, length) = match kind.split_once('[') {
            None => (kind, Length::One),
            Some((bare, length)) => {
                let length = length.strip_suffix(']').ok_or_else(unreadable)?;
                let any = length.is_empty() || length.starts_with("<=");
                let fixed = || length.parse().map_err(|_| unreadable());
                let length = if any {
                    Length::Any
                } else {
                    Length::Fixed(fixed()?)
                };
                (bare, length)
            }
        };
        // `string<=10`
        let bare = bare.split("<=").next().unwrap_or(bare);
        let kind = match simple(self.dialect, bare) {
            Some(kind) => kind,
            None => {
                let own = short(bare);
                let full = match own.contains('/') {
                    true => own,
                    false if own == "Header" => "std_msgs/Header".into(),
                    false => format!("{package}/{own}"),
                };
                Kind::Fields(self.definition(&full, depth + 1)?)
            }
        };
        let is_empty = match kind {
            Kind::Fields(place) => self.all.get(place).is_none_or(Vec::is_empty),
            _ => false,
        };
        if is_empty || length == Length::Fixed(0) {
            return match length {
                Length::Any => Err("a list of empty messages".into()),
                _ => Ok(None),
            };
        }
        Ok(Some(Field {
            name: name.to_string(),
            kind,
            length,
        }))
    }
}

/// Built-in types.
fn simple(dialect: Dialect, kind: &str) -> Option<Kind> {
    let number = match kind {
        "bool" | "uint8" | "char" => Number::Unsigned(1),
        "byte" if dialect == Dialect::Ros2 => Number::Unsigned(1),
        "int8" | "byte" => Number::Signed(1),
        "int16" => Number::Signed(2),
        "uint16" => Number::Unsigned(2),
        "int32" => Number::Signed(4),
        "uint32" => Number::Unsigned(4),
        "int64" => Number::Signed(8),
        "uint64" => Number::Unsigned(8),
        "float32" => Number::Single,
        "float64" => Number::Double,
        "string" => return Some(Kind::Text),
        "time" if dialect == Dialect::Ros1 => return Some(Kind::Moment),
        "duration" if dialect == Dialect::Ros1 => return Some(Kind::Span),
        "builtin_interfaces/Time" | "builtin_interfaces/msg/Time" => return Some(Kind::Moment),
        "builtin_interfaces/Duration" | "builtin_interfaces/msg/Duration" => {
            return Some(Kind::Span);
        }
        _ => return None,
    };
    Some(Kind::Number(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_refer_to_each_other() {
        let text = "Header header\nuint8 A=3\nPart[<=4] parts # of it\nnone/Empty e\nfloat64[0] no\n\
                    ================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
                    ================\nMSG: rig/Part\nfloat32[3] x\n================\nMSG: none/Empty\n";
        let read = Definitions::read(Dialect::Ros2, "rig/msg/Rig", text).unwrap();
        let names: Vec<&str> = read.all[read.message]
            .iter()
            .map(|f| f.name.as_str())
            .collect();
        assert_eq!(names, ["header", "parts", "e"]);
        assert_eq!(read.all[0][0].kind, Kind::Moment);
        let text = text.replace("builtin_interfaces/Time", "time");
        let read = Definitions::read(Dialect::Ros1, "rig/Rig", &text).unwrap();
        assert_eq!(read.all[read.message].len(), 2);
        let circle = "rig/Rig x\n";
        let why = Definitions::read(Dialect::Ros1, "rig/Rig", circle).unwrap_err();
        assert_eq!(why, "nested too deeply");
        let list = "none/Empty[] e\n====\nMSG: none/Empty\n";
        assert!(Definitions::read(Dialect::Ros1, "rig/Rig", list).is_err());
    }
}
