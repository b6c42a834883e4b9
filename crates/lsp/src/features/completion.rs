//! What may be typed at a position.
//!
//! In: a position, the tables in the model's folder, whether the editor supports snippets. Out: words of the language that fit the context, declared names,
//! columns. The context comes from the tokens before the position, so that half a statement is enough.

use std::ops::Range;

use lsp_types::{
    CompletionItem, CompletionItemKind as Kind, CompletionTextEdit, Documentation,
    InsertTextFormat, MarkupContent, MarkupKind, Position, TextEdit,
};
use sidc_lang::ast::Keyword;
use sidc_lang::library::GENERATORS;
use sidc_lang::model::Between;
use sidc_lang::term::{FUNCTIONS, Language, SignalNames};

use crate::analysis::folder::TableHeader;
use crate::analysis::libraries::sought;
use crate::analysis::symbols::{Symbol, SymbolKind};
use crate::analysis::words::{Role, Word};
use crate::features::completion_context::{Context, context};
use crate::text::document::Document;
use crate::thresholds::EDITOR;
use crate::vocabulary::{self, Entry};

pub fn items(
    document: &Document,
    at: Position,
    snippets: bool,
    tables: impl Fn() -> Vec<TableHeader>,
) -> Vec<CompletionItem> {
    let at = document.offset(at);
    let mut list = List {
        document,
        snippets,
        replaced: replaced(document, at),
        out: Vec::new(),
    };
    match context(document, at) {
        Context::Nothing => {}
        Context::Statement => list.statements(),
        Context::Attributes(keyword) => list.attributes(keyword),
        Context::Norm => list.entries(&[vocabulary::DEGREE, vocabulary::PLAIN], Kind::PROPERTY),
        Context::Limit => list.entries(&[vocabulary::DEGREE], Kind::PROPERTY),
        Context::DataEntry => list.data_entries(),
        Context::Column { quoted } => list.columns(&tables(), quoted),
        Context::Variables => list.variables(),
        Context::Target => list.targets(),
        Context::Term { of: (start, end) } => list.terms(document.slice(start..end)),
        Context::Expression => list.expression(),
    }
    list.out
}

fn on_one_line(text: &str) -> String {
    text.split('\n')
        .map(str::trim)
        .collect::<Vec<_>>()
        .join(" ")
}

/// The bytes of the word being typed; inside quotes, everything up to the quote.
fn replaced(document: &Document, at: usize) -> Range<usize> {
    match document.analysis().typed(at) {
        Some(w) if w.role == Role::Text => {
            let text = document.slice(w.bytes.clone());
            let closed = text.len() > 1 && text.ends_with('"');
            w.bytes.start + 1..w.bytes.end - usize::from(closed)
        }
        Some(w) if is_name(w) => w.bytes.start..at,
        _ => at..at,
    }
}

fn is_name(word: &Word) -> bool {
    !matches!(
        word.role,
        Role::Symbol | Role::Number | Role::Comment | Role::Text
    )
}

struct List<'a> {
    document: &'a Document,
    snippets: bool,
    replaced: Range<usize>,
    out: Vec<CompletionItem>,
}

impl List<'_> {
    /// `form` may have places to fill in; `group` orders the groups.
    fn push(&mut self, label: &str, form: &str, kind: Kind, detail: String, group: u8) {
        let (format, text) = match self.snippets && form.contains("${") {
            true => (InsertTextFormat::SNIPPET, form.to_string()),
            // Editors without snippets may insert a line break unchanged into a line.
            false => (
                InsertTextFormat::PLAIN_TEXT,
                on_one_line(&vocabulary::plain(form)),
            ),
        };
        self.add(label, (format, text), kind, detail, group);
    }

    /// A text that is inserted verbatim.
    fn literal(&mut self, text: &str, kind: Kind, detail: String, group: u8) {
        let inserted = (InsertTextFormat::PLAIN_TEXT, text.to_string());
        self.add(text, inserted, kind, detail, group);
    }

    fn add(
        &mut self,
        label: &str,
        (format, text): (InsertTextFormat, String),
        kind: Kind,
        detail: String,
        group: u8,
    ) {
        let range = self.document.range(self.replaced.clone());
        self.out.push(CompletionItem {
            label: label.to_string(),
            kind: Some(kind),
            detail: Some(detail).filter(|d| !d.is_empty()),
            sort_text: Some(format!("{group}{label}")),
            insert_text_format: Some(format),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, text))),
            ..CompletionItem::default()
        });
    }

    fn explain(&mut self, text: &str) {
        if let Some(item) = self.out.last_mut() {
            item.documentation = Some(Documentation::MarkupContent(MarkupContent {
                kind: MarkupKind::Markdown,
                value: text.to_string(),
            }));
        }
    }

    fn entries<'e>(&mut self, entries: impl IntoIterator<Item = &'e Entry>, kind: Kind) {
        for e in entries {
            self.push(e.word, e.form, kind, vocabulary::plain(e.form), 2);
            self.explain(e.meaning);
        }
    }

    /// Missing equations, then keywords.
    fn statements(&mut self) {
        let analysis = self.document.analysis();
        let equations: Vec<&str> = analysis
            .statements
            .iter()
            .filter(|s| s.keyword.is_none())
            .filter_map(|s| {
                self.document
                    .slice(s.bytes.clone())
                    .split(['~', '='])
                    .next()
            })
            .collect();
        let has = |target: &str| {
            let mut targets = equations.iter().flat_map(|left| left.split(','));
            let digits = |c: char| c.is_ascii_digit();
            targets.any(|t| match t.trim().split_once('[') {
                // Here `target` may belong to a family of equations.
                Some((stem, _)) => target.trim_end_matches(digits) == stem,
                None => t.trim() == target,
            })
        };
        let included = analysis.included.values().flat_map(|f| &f.symbols.all);
        for symbol in analysis.symbols.all.iter().chain(included) {
            let target = target_of(symbol, self.is_discrete());
            if let Some(target) = target.filter(|t| !has(t)) {
                let form = format!("{target} ~ ${{1:library}}");
                self.push(
                    &format!("{target} ~"),
                    &form,
                    Kind::EVENT,
                    "equation".into(),
                    1,
                );
            }
        }
        self.entries(&vocabulary::STATEMENTS, Kind::KEYWORD);
    }

    fn is_discrete(&self) -> bool {
        let next = |w: &&Word| self.document.slice(w.bytes.clone()) == "next";
        self.document.analysis().words.iter().any(|w| next(&w))
    }

    fn attributes(&mut self, keyword: Keyword) {
        let known = vocabulary::attributes(keyword);
        let said = self.said();
        let hidden = said.contains(&"hidden");
        // Words for sensors do not apply to a hidden state.
        let of_sensors = |word: &str| matches!(word, "noise" | "memory" | "delay");
        let measured = said.iter().any(|word| of_sensors(word));
        let fits = |e: &&Entry| {
            let moves = |word: &str| Between::named(word).is_some();
            let contradicts = hidden && of_sensors(e.word)
                || measured && e.word == "hidden"
                || moves(e.word) && said.iter().any(|word| moves(word));
            known.contains(&e.word) && !said.contains(&e.word) && !contradicts
        };
        let entries: Vec<&Entry> = vocabulary::ATTRIBUTES.iter().filter(fits).collect();
        self.entries(entries, Kind::PROPERTY);
        if keyword == Keyword::Unknown || keyword == Keyword::Coef {
            let about = "a value of its own in each run".to_string();
            self.push("per run", "per run", Kind::PROPERTY, about, 2);
        }
    }

    /// The words of the statement before the position.
    fn said(&self) -> Vec<&str> {
        let analysis = self.document.analysis();
        let start = analysis.statement(self.replaced.start);
        let start = start.map_or(usize::MAX, |(_, s)| s.bytes.start);
        let own = |w: &&Word| start <= w.bytes.start && w.bytes.end <= self.replaced.start;
        let words = analysis.words.iter().filter(own);
        words
            .map(|w| self.document.slice(w.bytes.clone()))
            .collect()
    }

    fn data_entries(&mut self) {
        self.push("t", "t = ${1:\"Time\"}", Kind::VARIABLE, "time".into(), 1);
        let symbols: Vec<Symbol> = self.document.analysis().symbols.all.clone();
        let measured = |s: &&Symbol| is_variable(s) && s.kind != SymbolKind::Unknown && !s.hidden;
        for symbol in symbols.iter().filter(measured) {
            let form = format!("{} = ${{1:\"Column\"}}", symbol.name);
            self.push(&symbol.name, &form, Kind::VARIABLE, kind(symbol).into(), 1);
        }
        let [step, run, _] = &vocabulary::DATA;
        self.entries([step, run], Kind::PROPERTY);
    }

    /// Columns of the tables in the folder, without duplicates, and the functions that may wrap a column.
    fn columns(&mut self, tables: &[TableHeader], quoted: bool) {
        let mut seen = std::collections::BTreeSet::new();
        for (place, table) in tables.iter().enumerate() {
            for column in table.columns.iter().filter(|c| !c.is_empty()) {
                // A header with a quote or a line end cannot be written in a model.
                if column.contains(['"', '\n']) || !seen.insert(column) {
                    continue;
                }
                let text = match quoted {
                    true => column.clone(),
                    false => format!("\"{column}\""),
                };
                let group = u8::from(place > 0);
                self.literal(&text, Kind::FIELD, table.file.clone(), group);
            }
        }
        if !quoted {
            let [.., none] = &vocabulary::DATA;
            let unwrap = vocabulary::FORMS.iter().filter(|e| e.word == "unwrap");
            let entries: Vec<&Entry> = unwrap.chain([none]).collect();
            self.entries(entries, Kind::FUNCTION);
        }
    }

    fn variables(&mut self) {
        let symbols: Vec<Symbol> = self.document.analysis().symbols.all.clone();
        for symbol in symbols.iter().filter(|s| is_variable(s)) {
            let about = kind(symbol).to_string();
            self.push(&symbol.name, &symbol.name, Kind::VARIABLE, about, 1);
        }
    }

    fn targets(&mut self) {
        let symbols: Vec<Symbol> = self.document.analysis().symbols.all.clone();
        let discrete = self.is_discrete();
        for target in symbols.iter().filter_map(|s| target_of(s, discrete)) {
            self.push(&target, &target, Kind::VARIABLE, "target".into(), 1);
        }
    }

    /// The terms of an equation's library; if it is not searched for, what terms are built from.
    fn terms(&mut self, target: &str) {
        let document = self.document;
        // `next x` and `next(x)` mean the same.
        let plain = |name: &str| name.replace(['(', ')', ' '], "");
        let sought = document.program().and_then(|program| {
            let mut all = sought(program);
            let (_, library) =
                all.find(|(e, _)| plain(&program.model.name(e.target)) == plain(target))?;
            Some((Language(&program.model), library))
        });
        let Some((names, library)) = sought else {
            return self.expression();
        };
        for (_, term) in library.terms().take(EDITOR.offered) {
            let about = format!("term of {target}");
            self.literal(&names.term(&term), Kind::VALUE, about, 1);
        }
    }

    /// Functions of the model, and the arguments of the function being defined.
    fn functions(&mut self) {
        let analysis = self.document.analysis();
        // A function cannot be used in its own definition.
        let at = self.replaced.start;
        let is_function = |s: &&Symbol| {
            s.kind == SymbolKind::Function && !(s.statement.start..=s.statement.end).contains(&at)
        };
        for f in analysis.symbols.all.iter().filter(is_function) {
            let arguments = analysis.symbols.arguments_of(f.statement.start);
            let names: Vec<&str> = arguments.map(|a| a.name.as_str()).collect();
            let places = (1..).zip(&names).map(|(i, a)| format!("${{{i}:{a}}}"));
            let places: Vec<String> = places.collect();
            let form = format!("{}({})", f.name, places.join(", "));
            let detail = self.document.slice(f.statement.clone());
            let detail = detail.split_whitespace().collect::<Vec<_>>().join(" ");
            self.push(&f.name, &form, Kind::FUNCTION, detail, 1);
        }
        let own = analysis.statement(self.replaced.start);
        let start = own.map_or(usize::MAX, |(_, s)| s.bytes.start);
        for a in analysis.symbols.arguments_of(start) {
            self.push(&a.name, &a.name, Kind::VARIABLE, kind(a).into(), 1);
        }
    }

    fn expression(&mut self) {
        let analysis = self.document.analysis();
        let names: Vec<(String, usize)> = analysis
            .symbols
            .spellings()
            .map(|(name, used)| (name.to_string(), used.symbol))
            .collect();
        for (name, symbol) in names {
            let Some(symbol) = analysis.symbols.all.get(symbol) else {
                continue;
            };
            if symbol.kind == SymbolKind::Function {
                continue;
            }
            let detail = match name == symbol.name {
                true => kind(symbol).to_string(),
                false => format!("derivative of {}", symbol.name),
            };
            self.push(&name, &name, Kind::VARIABLE, detail, 1);
        }
        for file in analysis.included.values() {
            for (name, _) in file.symbols.spellings().filter(|(name, _)| *name != "t") {
                let detail = format!("of {}", file.name);
                self.push(name, name, Kind::VARIABLE, detail, 1);
            }
        }
        self.functions();
        for (name, about) in [("t", "time"), ("pi", "π")] {
            self.push(name, name, Kind::CONSTANT, about.into(), 3);
        }
        for g in GENERATORS {
            let form = vocabulary::form_of_usage(g.usage());
            self.push(g.name(), &form, Kind::SNIPPET, g.usage().into(), 2);
            self.explain(g.about());
        }
        for f in FUNCTIONS {
            let form = match f.arity {
                (1, 1) => format!("{}(${{1:x}})", f.name),
                _ => format!("{}(${{1:x}}, ${{2:y}})", f.name),
            };
            self.push(f.name, &form, Kind::FUNCTION, vocabulary::plain(&form), 3);
        }
        let inside = |e: &&Entry| e.word != "unwrap";
        let forms: Vec<&Entry> = vocabulary::FORMS.iter().filter(inside).collect();
        self.entries(forms, Kind::FUNCTION);
    }
}

/// For example `ddx` for a state of order 2; `next x` in discrete time; the name of an output.
fn target_of(symbol: &Symbol, discrete: bool) -> Option<String> {
    match symbol.kind {
        SymbolKind::State if discrete => Some(format!("next {}", symbol.name)),
        SymbolKind::State => Some("d".repeat(symbol.order) + &symbol.name),
        SymbolKind::Output => Some(symbol.name.clone()),
        _ => None,
    }
}

fn is_variable(symbol: &Symbol) -> bool {
    use SymbolKind::{Argument, Function, Let};
    !matches!(symbol.kind, Let | Function | Argument)
}

fn kind(symbol: &Symbol) -> &'static str {
    match symbol.kind {
        SymbolKind::Time => "time",
        SymbolKind::State => "state",
        SymbolKind::Input => "input",
        SymbolKind::Output => "output",
        SymbolKind::Param => "parameter",
        SymbolKind::Unknown => "unknown constant",
        SymbolKind::Let => "let",
        SymbolKind::Function => "function",
        SymbolKind::Argument => "argument",
    }
}
