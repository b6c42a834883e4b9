//! Explains a word: unit, order and declaration of a name; size, memory and terms of a library; usage of a function.
//!
//! In: a position, and the tables in the model's folder. Out: Markdown. Texts from files are put in code blocks, so that no name becomes a heading or a link.

use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind, Position};
use sidc_lang::library::{Library, generator, size, storage};
use sidc_lang::term::{FUNCTIONS, Language, SignalNames};
use sidc_lang::units::{self, Unit};

use crate::analysis::OWN;
use crate::analysis::folder::TableHeader;
use crate::analysis::libraries;
use crate::analysis::symbols::{Symbol, SymbolKind, Use};
use crate::analysis::words::{Role, Word};
use crate::text::document::Document;
use crate::thresholds::EDITOR;
use crate::vocabulary;

pub fn hover(
    document: &Document,
    at: Position,
    tables: impl Fn() -> Vec<TableHeader>,
) -> Option<Hover> {
    let analysis = document.analysis();
    let at = document.offset(at);
    let word = match analysis.name(at) {
        Some((word, _)) => word,
        None => analysis.word(at)?,
    };
    let text = document.slice(word.bytes.clone());
    let value = match word.role {
        Role::Declaration(used) | Role::Use(used) => name(document, used, text)?,
        Role::Generator => generated(document, word, text)?,
        Role::Function => function(text)?,
        Role::Keyword => entry(vocabulary::STATEMENTS.iter(), text)?,
        Role::Attribute => {
            let more = [vocabulary::DEGREE, vocabulary::PLAIN, vocabulary::CYCLIC];
            let all = vocabulary::ATTRIBUTES.iter().chain(&vocabulary::DATA);
            entry(all.chain(&more), text)?
        }
        Role::Constant if text == "pi" => "`pi` is π".into(),
        Role::Constant => format!("`t` is time{}", unit_of_time(document)),
        Role::Symbol if text == "~" => sought(document, word)?,
        Role::Text => column(text.trim_matches('"').trim(), &tables())?,
        _ => return None,
    };
    Some(Hover {
        contents: HoverContents::Markup(MarkupContent {
            kind: MarkupKind::Markdown,
            value,
        }),
        range: Some(document.range(word.bytes.clone())),
    })
}

fn entry<'a>(mut all: impl Iterator<Item = &'a vocabulary::Entry>, word: &str) -> Option<String> {
    let found = all.find(|e| e.word == word)?;
    Some(format!(
        "{}\n\n{}",
        code(&vocabulary::plain(found.form)),
        found.meaning
    ))
}

/// A text in a code block, however many backticks it has.
fn code(text: &str) -> String {
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    let fence = "`".repeat(longest.max(2) + 1);
    format!("{fence}sid\n{text}\n{fence}")
}

fn name(document: &Document, used: Use, written: &str) -> Option<String> {
    let symbol = document.analysis().symbols.get(used)?;
    let line = 1 + document.lines().line(symbol.place.start);
    let mut text = format!("`{written}`: {}", kind(symbol, used.derivative));
    if let Some(unit) = unit(document, symbol, used.derivative) {
        text.push_str(&format!(", in `{unit}`"));
    }
    let all = document.slice(symbol.statement.clone());
    text.push_str(&format!("\n\nline {line}:\n{}", code(all)));
    let about = match symbol.kind {
        SymbolKind::Let | SymbolKind::Function => named_library(document, symbol),
        SymbolKind::Argument => None,
        _ => target(document, &("d".repeat(used.derivative) + &symbol.name)),
    };
    if let Some(about) = about {
        text.push_str(&format!("\n\n{about}"));
    }
    Some(text)
}

fn kind(symbol: &Symbol, derivative: usize) -> String {
    let name = &symbol.name;
    let of = match symbol.kind {
        SymbolKind::Time => "time".to_string(),
        SymbolKind::State if symbol.hidden => {
            format!(
                "hidden state of order {}, which nothing measures",
                symbol.order
            )
        }
        SymbolKind::State => format!("state of order {}", symbol.order),
        SymbolKind::Input => "input".into(),
        SymbolKind::Output => "output".into(),
        SymbolKind::Param => "parameter, constant along a trajectory".into(),
        SymbolKind::Unknown => "unknown constant, sought with the terms".into(),
        SymbolKind::Let => "defined by `let`".into(),
        SymbolKind::Function => "function that this model defines".into(),
        SymbolKind::Argument => "argument of the function".into(),
    };
    match derivative {
        0 => of,
        1 => format!("first derivative of `{name}`, {of}"),
        2 => format!("second derivative of `{name}`, {of}"),
        3 => format!("third derivative of `{name}`, {of}"),
        n => format!("derivative {n} of `{name}`, {of}"),
    }
}

/// The unit of a derivative: the unit of its variable divided by powers of that of time.
fn unit(document: &Document, symbol: &Symbol, derivative: usize) -> Option<Unit> {
    let symbols = &document.analysis().symbols;
    let parse = |text: &String| Some(units::parse(text).ok()?.0);
    let own = symbol.unit.as_ref().and_then(parse)?;
    let time = symbols.all.iter().find(|s| s.kind == SymbolKind::Time);
    let time = time.and_then(|t| t.unit.as_ref()).and_then(parse);
    let time = time.unwrap_or_else(Unit::second);
    units::derivative(&own, &time, derivative as u8)
}

fn unit_of_time(document: &Document) -> String {
    let any = document
        .analysis()
        .symbols
        .all
        .iter()
        .any(|s| s.unit.is_some());
    match any {
        true => ", in `s` unless `input t : unit …` says otherwise".into(),
        false => String::new(),
    }
}

/// The library of a target.
fn target(document: &Document, canonical: &str) -> Option<String> {
    let program = document.program()?;
    let sought = |(e, _): &(&sidc_lang::model::Equation, &Library)| {
        program.model.name(e.target) == canonical
    };
    let (_, library) = libraries::sought(program).find(sought)?;
    Some(described(document, library))
}

/// The libraries of the equations with this `~`.
fn sought(document: &Document, tilde: &Word) -> Option<String> {
    let program = document.program()?;
    let here = libraries::sought(program)
        .filter(|(e, _)| e.span.file == OWN)
        .filter(|(e, _)| e.span.start <= tilde.bytes.start && tilde.bytes.end <= e.span.end);
    let each = here.map(|(e, library)| {
        format!(
            "`{}` ~ {}",
            program.model.name(e.target),
            described(document, library)
        )
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| each.join("\n\n"))
}

fn named_library(document: &Document, symbol: &Symbol) -> Option<String> {
    let program = document.program()?;
    let part = libraries::named(program, &symbol.name)?;
    Some(described(document, &part.library(program)))
}

/// Size, memory and the first terms of a library.
fn described(document: &Document, library: &Library) -> String {
    let Some(program) = document.program() else {
        return String::new();
    };
    let names = Language(&program.model);
    let shown = library.terms().take(EDITOR.terms);
    let mut terms: Vec<String> = shown.map(|(_, term)| names.term(&term)).collect();
    if library.len() > terms.len() {
        terms.push("…".into());
    }
    let size = size(&program.model, library);
    format!("{size}; {}\n{}", storage(library), code(&terms.join(", ")))
}

fn generated(document: &Document, word: &Word, name: &str) -> Option<String> {
    let generator = generator(name)?;
    let mut text = format!("{}\n\n{}", code(generator.usage()), generator.about());
    let program = document.program();
    let part = program.and_then(|p| libraries::generated(p, word.bytes.start).map(|g| (p, g)));
    if let Some((program, part)) = part {
        let library = part.library(program);
        text.push_str(&format!("\n\nhere: {}", described(document, &library)));
    }
    Some(text)
}

fn function(name: &str) -> Option<String> {
    if let Some(text) = entry(vocabulary::FORMS.iter(), name) {
        return Some(text);
    }
    let f = FUNCTIONS.iter().find(|f| f.name == name)?;
    let form = match f.arity {
        (1, 1) => format!("{name}(x)"),
        _ => format!("{name}(x, y)"),
    };
    let domain = match f.domain {
        "" => "takes any number".to_string(),
        domain => format!("takes {domain}"),
    };
    Some(format!("{}\n\n{domain}", code(&form)))
}

/// The files in the folder that have a column.
fn column(header: &str, tables: &[TableHeader]) -> Option<String> {
    let has = |t: &&TableHeader| t.columns.iter().any(|c| c == header);
    let files: Vec<String> = tables.iter().filter(has).map(|t| t.file.clone()).collect();
    match files.is_empty() {
        true => None,
        false => Some(format!("column of\n{}", code(&files.join("\n")))),
    }
}
