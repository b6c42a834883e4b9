//! Undeclared names, and what was probably meant.
//!
//! In: a name and its place. Out: one error for each name, with the nearest name in scope or the way to declare it.

use crate::ast::{Call, Entry, EntryKind, Expr as Ast, Keyword, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::undeclared_constants::Undeclared;
use crate::diagnostic::{Diagnostic, Edit, Fix, did_you_mean};
use crate::model::VarKind;
use crate::parse::confusables;
use crate::parse::foreign_spellings::functions::{self, Translation};
use crate::source::Span;
use crate::term::FUNCTIONS;
use crate::thresholds::MESSAGES;

/// Words that have a meaning in one place only, and where.
const PLACED: [(&str, &str); 6] = [
    (
        "known",
        "`known(…)` is a summand of its own on the right of `~`: `dx ~ known(-9.8*x) + poly(x; 3)`",
    ),
    (
        "required",
        "`required(…)` is a summand of its own on the right of `~`: `dx ~ required(x, x^3) + poly(x; 5)`",
    ),
    (
        "coef",
        "`coef(…)` stands in a constraint: `constrain coef(dx, x) < 0`",
    ),
    (
        "unwrap",
        "`unwrap(…)` stands in the data block: `theta = unwrap(\"Angle\", 2*pi)`",
    ),
    (
        "delay",
        "a delay is declared with its input: `input u : delay 0.1`; in discrete time `lag(u, k)` is k samples back",
    ),
    ("next", "`next(x)` takes one state"),
];

impl Checker<'_> {
    /// Reports an unknown name, once.
    pub fn unknown_name<T>(&mut self, at: Span, text: &str) -> Option<T> {
        let plain = text.trim_end_matches('\'');
        if plain != text && self.argument(plain).is_some() {
            let last = self.last_param(at);
            return self.fail(errors::argument_differentiated(at, plain, last));
        }
        if self.scope.may_be_declared(text) || !self.reported.insert(text.to_string()) {
            return None;
        }
        if self.reported.len() > MESSAGES.unknown_names {
            // The model fails anyway, and each report costs a search among all names.
            return None;
        }
        if self.derivative_in_discrete(at, text) {
            return None;
        }
        if self.meant(text).is_none()
            && !self.is_own_function(text)
            && let Undeclared::Coefficients(found) = self.undeclared(at)
        {
            let d = self.undeclared_coefficients(at, &found);
            return self.fail(d);
        }
        let d = self.describe_unknown(at, text);
        self.fail(d)
    }

    /// Whether the data block has an entry for this name.
    fn has_column(&self, text: &str) -> bool {
        let mut blocks = self.statements().filter_map(|s| match &s.kind {
            StatementKind::Data(entries) => Some(entries),
            _ => None,
        });
        let names =
            |e: &Entry| matches!(&e.kind, EntryKind::Source { name, .. } if name.text == text);
        blocks.any(|entries| entries.iter().any(names))
    }

    fn describe_unknown(&self, at: Span, text: &str) -> Diagnostic {
        if self.function_named(text).is_some() {
            return self.without_argument(at, text);
        }
        if let Some(generator) = self.generator_named(text) {
            let example = self.generator_example(generator, None);
            return errors::generator_without_arguments(at, generator.name, &example);
        }
        if self.is_own_function(text) {
            return self.without_argument(at, text);
        }
        if let Some((later, whole)) = self.later_let(text) {
            return match whole.holds(at) {
                true => errors::recursive(at, text, later),
                false => errors::let_used_before(at, text, later),
            };
        }
        let d = Diagnostic::error("unknown-signal", format!("no signal named `{text}`"));
        let constant = functions::constant(text).map(str::to_string);
        // A name with an entry in the data block is not a misspelling of another.
        let meant = constant
            .or_else(|| self.meant(text))
            .filter(|_| !self.has_column(text));
        let d = match &meant {
            Some(name) => {
                let d = d.at(at, format!("did you mean `{name}`?")).fix(at, name);
                self.point_to_declaration(d, name)
            }
            None => d.at(at, "not declared"),
        };
        let d = d.fact(format!("in scope: {}", self.scope.in_scope()));
        let plain = plain(text);
        let known = self.scope.signal(&plain).is_some();
        match self.too_high_derivative(&plain).filter(|_| !known) {
            Some((help, fix)) => match fix {
                Some(fix) if plain == text => d.help(help).fix(fix.span, fix.text),
                Some(fix) => d.help(help).edit_all([
                    Edit::Replace(fix.span, fix.text),
                    Edit::Replace(at, plain),
                ]),
                None => d.help(help),
            },
            None if meant.is_some() => d,
            None if Keyword::named(text).is_some() => d
                .help(format!(
                    "as the word that opens a statement `{text}` misses what it is about, before the `=` or `~`: complete it, or delete the \
                     line; as a name declare it: `state {text}`"
                ))
                .edit(Edit::RemoveStatement(at)),
            None => match self.undeclared(at) {
                Undeclared::InsideTerm => self.declaring(d, at, self.keywords_inside(at), text).help(format!(
                    "a number that is not known is sought with the terms: add the line `unknown {text}`; a signal or a known number is \
                     declared by `state {text}`, `input {text}` or `let {text} = …`"
                )),
                _ => self.declaring(d, at, &["state", "input"], text).help(format!(
                    "declare it: `state {text}`, `input {text}` or `let {text} = …`"
                )),
            },
        }
    }

    /// Keywords that may declare a name inside a term; an exponent is not a signal.
    fn keywords_inside(&self, at: Span) -> &'static [&'static str] {
        let before = self.file.text_of(at.file).get(..at.start).unwrap_or("");
        match before.trim_end_matches([' ', '(', '-']).ends_with('^') {
            true => &["unknown"],
            false => &["unknown", "state", "input"],
        }
    }

    /// Fixes that declare a name in a line of its own before the statement at `at`.
    pub fn declaring(&self, d: Diagnostic, at: Span, keywords: &[&str], name: &str) -> Diagnostic {
        let statement = self.statements().find(|s| s.span.holds(at));
        let Some(before) = statement.map(|s| s.span.before()) else {
            return d;
        };
        let fixes = keywords.iter().map(|k| format!("{k} {name}\n"));
        fixes.fold(d, |d, line| d.fix(before, line))
    }

    fn without_argument(&self, at: Span, name: &str) -> Diagnostic {
        let (negated, example) = (self.negated_name_after(at), self.example_name());
        errors::function_without_argument(at, name, negated, example)
    }

    /// The `x` of `sin -x`, and its place.
    fn negated_name_after(&self, at: Span) -> Option<(&str, Span)> {
        let text = self.file.text_of(at.file);
        let rest = text.get(at.end..)?.trim_start().strip_prefix('-')?;
        let rest = rest.trim_start();
        let start = text.len() - rest.len();
        let end = rest
            .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '\''))
            .unwrap_or(rest.len());
        let name = rest.get(..end).filter(|name| !name.is_empty())?;
        Some((name, Span::new(at.file, start, start + end)))
    }

    /// The name in scope that was probably meant.
    fn meant(&self, text: &str) -> Option<String> {
        let names = || self.scope.signals.keys().chain(self.scope.lets.keys());
        let plain = plain(text);
        let spelt = confusables::spelt_out(&plain);
        let same = names().find(|n| **n == plain || confusables::spelt_out(n) == spelt);
        if let Some(name) = same {
            return Some(name.clone());
        }
        if self.scope.signal(&plain).is_some() {
            return Some(plain);
        }
        // Every letter is one edit from every other, so only the other case of one letter counts as near.
        let short = text.chars().count() == 1;
        let near = names()
            .map(String::as_str)
            .filter(|n| !short || n.to_lowercase() == text.to_lowercase())
            .filter(|n| *n != "t" || text == "T");
        did_you_mean(text, near).map(str::to_string)
    }

    fn point_to_declaration(&self, d: Diagnostic, name: &str) -> Diagnostic {
        if let Some(s) = self.scope.signal(name) {
            let span = self.scope.var(s.var).and_then(|v| v.span);
            return match span {
                Some(span) => d.also(span, format!("declares {}", self.scope.spellings(s.var))),
                None => d,
            };
        }
        match self.scope.lets.get(name) {
            Some(l) => d.also(l.span, format!("defines {name}")),
            None => d,
        }
    }

    /// For `ddx` where `x` has order 1: the declaration that it needs, and the fix that makes it.
    fn too_high_derivative(&self, text: &str) -> Option<(String, Option<Fix>)> {
        let primes = text.len() - text.trim_end_matches('\'').len();
        let base = text.trim_end_matches('\'');
        let cut = (1..=base.len() - base.trim_start_matches('d').len())
            .rev()
            .chain([0])
            .find(|k| {
                base.get(*k..)
                    .is_some_and(|rest| self.scope.signals.contains_key(rest))
            })?;
        let rest = base.get(cut..)?;
        let s = self.scope.signals.get(rest)?;
        let var = self.scope.var(s.var).filter(|v| v.span.is_some())?;
        let order = usize::from(s.der) + cut + primes;
        let keyword = match var.kind {
            VarKind::State => "state",
            VarKind::Input => "input",
            _ => return None,
        };
        let help = format!("declare `{keyword} {} : order {order}`", var.name);
        Some((help, self.raised_order(var.span?, order)))
    }

    /// A fix that sets the order of the name declared at `declared`.
    fn raised_order(&self, declared: Span, order: usize) -> Option<Fix> {
        self.statements().find_map(|s| {
            let StatementKind::Declare { attributes, .. } = &s.kind else {
                return None;
            };
            let holds = s.span.holds(declared);
            let said = attributes.iter().find(|a| a.key.text == "order");
            let (span, text) = match said.map(|a| &a.value) {
                Some(Some(value)) => (value.span, order.to_string()),
                Some(None) => return None,
                None if attributes.is_empty() => (s.span.after(), format!(" : order {order}")),
                None => (s.span.after(), format!(", order {order}")),
            };
            holds.then_some(Fix { span, text })
        })
    }

    /// The place after the arguments of the function definition that holds `at`.
    fn last_param(&self, at: Span) -> Option<Span> {
        match &self.file.statement_at(at)?.kind {
            StatementKind::Function { params, .. } => Some(params.last()?.span.after()),
            _ => None,
        }
    }

    fn later_let(&self, text: &str) -> Option<(Span, Span)> {
        self.statements().find_map(|s| match &s.kind {
            StatementKind::Let { name, .. } if name.text == text => Some((name.span, s.span)),
            _ => None,
        })
    }

    /// Reports a call of something that is not a function: `x(1 - x)`, `x y`, `sine(x)`.
    pub fn not_a_function<T>(&mut self, e: &Ast, call: &Call) -> Option<T> {
        let name = call.name.text.as_str();
        let at = call.name.span;
        if let Some((_, help)) = PLACED.iter().find(|(word, _)| *word == name) {
            let d = errors::word_elsewhere(at, name, help);
            return self.fail(d.edit_all(self.in_its_place(e, call)));
        }
        if let Some(d) = self.own_function_before(at, name) {
            return self.fail(d);
        }
        if self.generator_named(name).is_some() {
            return self.fail(errors::library_inside(
                e.span,
                &format!("the library `{name}(…)`"),
            ));
        }
        if self.scope.may_be_declared(name) {
            return None;
        }
        if self.is_declared(name) {
            return self.product_without_sign(e, call);
        }
        if let Some(meant) = self.foreign_function(call) {
            if !self.reported.insert(name.to_string()) {
                return None;
            }
            let instead = self.instead_of(e, call).unwrap_or_default();
            return self.fail(errors::foreign_function(e.span, call, meant, instead));
        }
        let candidates = FUNCTIONS
            .iter()
            .map(|f| f.name)
            .chain(self.vocabulary.generators.iter().map(|g| g.name))
            .chain(["next", "lag", "known", "required"])
            .chain(self.functions.keys().map(String::as_str));
        let near = did_you_mean(name, candidates).map(str::to_string);
        if !self.reported.insert(name.to_string()) {
            return None;
        }
        self.fail(errors::unknown_function(
            at,
            name,
            near,
            &self.vocabulary.generators,
        ))
    }

    /// Edits that move a misplaced word to where it has a meaning.
    fn in_its_place(&self, e: &Ast, call: &Call) -> Vec<Edit> {
        match call.name.text.as_str() {
            "known" | "required" => vec![Edit::Summand(e.span)],
            "coef" => {
                let line = format!("constrain {} < 0", self.text(e.span));
                vec![Edit::Remove(e.span), Edit::Below(e.span, line)]
            }
            "delay" => self.declared_delay(e, call).unwrap_or_default(),
            _ => Vec::new(),
        }
    }

    /// `delay(u, 0.1)`: `u`, with the delay where it is declared.
    fn declared_delay(&self, e: &Ast, call: &Call) -> Option<Vec<Edit>> {
        let [signal, by] = call.args.as_slice() else {
            return None;
        };
        let name = signal.as_name()?;
        if self.scope.discrete.is_some() {
            let lag = format!("lag({name}, {})", self.text(by.span));
            return Some(vec![Edit::Replace(e.span, lag)]);
        }
        let declared = self.scope.var(self.scope.signal(name)?.var)?.span?;
        let delay = format!("delay {}", self.text(by.span));
        Some(vec![
            Edit::Replace(e.span, name.to_string()),
            Edit::Attribute(declared, "delay", delay),
        ])
    }

    /// Edits with the effect of a foreign function: a state for an integral, a name for a derivative.
    fn instead_of(&self, e: &Ast, call: &Call) -> Option<Vec<Edit>> {
        let [x] = call.args.as_slice() else {
            return None;
        };
        let text = self.text(x.span);
        match functions::kind(&call.name.text)? {
            functions::Kind::Derivative => {
                let name = format!("d{text}");
                self.scope.signal(&name)?;
                Some(vec![Edit::Replace(e.span, name)])
            }
            functions::Kind::Integral if self.scope.signal("q").is_none() => Some(vec![
                Edit::Replace(e.span, "q".to_string()),
                Edit::Above(e.span, format!("state q : hidden\ndq = {text}")),
            ]),
            functions::Kind::Limited => {
                let ours = format!("min(max({text}, -1), 1)");
                Some(vec![Edit::Replace(e.span, ours)])
            }
            _ => None,
        }
    }

    /// The error of a function that is called in or above its own definition.
    fn own_function_before(&self, at: Span, name: &str) -> Option<Diagnostic> {
        self.statements().find_map(|s| match &s.kind {
            StatementKind::Function { name: own, .. } if own.text == name => {
                Some(match s.span.holds(at) {
                    true => errors::recursive(at, name, own.span),
                    false => errors::let_used_before(at, name, own.span),
                })
            }
            _ => None,
        })
    }

    fn foreign_function(&self, call: &Call) -> Option<Translation> {
        let texts: Vec<&str> = call.args.iter().map(|a| self.text(a.span)).collect();
        functions::function(&call.name.text, &texts)
    }

    /// `x y`, `x(1 - y)`, or two lines of a list without a comma between them.
    fn product_without_sign<T>(&mut self, e: &Ast, call: &Call) -> Option<T> {
        let right = call.args.first().map_or(e.span, |a| a.span);
        let between = Span::new(at_file(e), call.name.span.end, right.start);
        if self.text(between).contains('\n') {
            let (left, right) = (self.text(call.name.span), self.text(right));
            return self.fail(errors::missing_comma(call.name.span, left, right));
        }
        let left = Span::new(at_file(e), e.span.start, call.name.span.end);
        let left = match call.power {
            Some((_, power)) => left.to(power),
            None => left,
        };
        let tail = Span::new(at_file(e), left.end, e.span.end);
        let (first, second) = (self.text(left), self.text(tail).trim());
        let fixed = format!("{first}*{second}");
        let listed = call.juxtaposed.then(|| format!("{first}, {second}"));
        self.fail(errors::product_without_sign(
            e.span,
            &call.name.text,
            &fixed,
            listed,
        ))
    }
}

fn at_file(e: &Ast) -> crate::source::FileId {
    e.span.file
}

/// A name with its derivatives written as leading `d`s.
fn plain(text: &str) -> String {
    let other = confusables::dotted(text).or_else(|| confusables::spelt_elsewhere(text));
    other.unwrap_or_else(|| text.to_string())
}
