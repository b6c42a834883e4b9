//! `data { }`: which column each signal is read from, and how it is converted.
//!
//! In: the entries of the block. Out: arithmetic on column headers. Never looks at a data file.

use std::collections::BTreeMap;

use crate::ast::{Call, Entry, EntryKind, Expr as Ast, ExprKind, Ident, Side, Sign};
use crate::check::checker::{Checker, every};
use crate::check::errors;
use crate::check::suggestions::is_atom;
use crate::model::{ColumnExpr, ColumnKind, DataBlock, DataEntry, VarKind};
use crate::source::Span;
use crate::term::Signal;
use crate::thresholds::MODEL;

impl Checker<'_> {
    pub fn data(&mut self, span: Span, entries: &[Entry]) -> DataBlock {
        let mut block = DataBlock {
            span: Some(span),
            ..DataBlock::default()
        };
        let mut seen: BTreeMap<Signal, Span> = BTreeMap::new();
        for entry in entries {
            match &entry.kind {
                EntryKind::Step(e) => self.step(entry.span, e, &mut block),
                EntryKind::Source {
                    name,
                    value,
                    beside,
                } => {
                    if name.text == "run" && self.scope.signal("run").is_none() {
                        match beside.last() {
                            Some(last) => {
                                let whole = value.span.to(last.span);
                                self.say(errors::run(whole, self.header(value)));
                            }
                            None => self.run(entry.span, value, &mut block),
                        }
                    } else if let Some(entry) = self.entry(name, (value, beside), &mut seen) {
                        block.entries.push(entry);
                    }
                }
            }
        }
        self.side_by_side(&block);
        block
    }

    /// Checks experiments side by side: all signals with several sources have equally many, and there is no column of runs.
    fn side_by_side(&mut self, block: &DataBlock) {
        let several = |e: &&DataEntry| !e.beside.is_empty();
        let Some(first) = block.entries.iter().find(several) else {
            return;
        };
        let name = |e: &DataEntry| {
            let var = self.scope.vars.get(usize::from(e.signal.var.0));
            let base = var.map_or("?", |v| v.name.as_str());
            format!("{}{base}", "d".repeat(usize::from(e.signal.der)))
        };
        let other = block
            .entries
            .iter()
            .filter(several)
            .find(|e| e.beside.len() != first.beside.len());
        if let Some(other) = other {
            let of = |e: &DataEntry| (e.span, name(e), 1 + e.beside.len());
            let all = other.source.iter().chain(&other.beside).map(|s| s.span);
            let whole = all.clone().reduce(Span::to).unwrap_or(other.span);
            let text = all.clone().next().map_or("none", |s| self.text(s));
            let d = errors::sources_differ(of(other), of(first), (whole, text));
            return self.say(d);
        }
        if let Some((_, run)) = &block.run {
            self.say(errors::side_by_side_with_run_column(first.span, *run));
        }
    }

    /// `step 0.01`
    fn step(&mut self, span: Span, e: &Ast, block: &mut DataBlock) {
        if let Some((_, first)) = block.step {
            return self.say(errors::twice(span, first, "`step`"));
        }
        let Some(value) = self.constant(e, "`step`") else {
            return;
        };
        if value > 0.0 {
            block.step = Some((value, span));
        } else {
            self.say(errors::step(e.span, value));
        }
    }

    /// `run = "exp_id"`
    fn run(&mut self, span: Span, value: &Ast, block: &mut DataBlock) {
        if let Some((_, first)) = &block.run {
            return self.say(errors::twice(span, *first, "`run`"));
        }
        match &value.kind {
            ExprKind::Text(text) => block.run = Some((text.trim().to_string(), span)),
            _ => self.say(errors::run(value.span, self.header(value))),
        }
    }

    /// The header that an expression names, with or without quotes.
    fn header(&self, e: &Ast) -> &str {
        let named = e.find(&|e| matches!(e.kind, ExprKind::Text(_) | ExprKind::Name(_)));
        named.map_or("exp_id", |e| self.text(e.span).trim_matches('"'))
    }

    /// `theta = "Angle" * 1e-3`, `dy = none`
    fn entry(
        &mut self,
        name: &Ident,
        (value, beside): (&Ast, &[Ast]),
        seen: &mut BTreeMap<Signal, Span>,
    ) -> Option<DataEntry> {
        let Some(signal) = self.scope.signal(&name.text) else {
            if let Some(l) = self.scope.lets.get(&name.text) {
                let d = errors::data_for_let(name.span, &name.text, l.span);
                return self.fail(d);
            }
            return self.unknown_name(name.span, &name.text);
        };
        if let Some(var) = self.scope.var(signal.var)
            && var.kind == VarKind::Unknown
        {
            let d = errors::data_for_unknown(name.span, &name.text, var.span);
            return self.fail(d);
        }
        if let Some(first) = seen.insert(signal, name.span) {
            return self.fail(errors::twice(
                name.span,
                first,
                &format!("entry for `{}`", name.text),
            ));
        }
        let none = value.as_name() == Some("none");
        let nothing = beside.iter().find(|e| e.as_name() == Some("none"));
        if let Some(at) = nothing.or(Some(value).filter(|_| none && !beside.is_empty())) {
            let whole = value.span.to(beside.last().map_or(value.span, |e| e.span));
            return self.fail(errors::nothing_in_one_run(at.span, whole));
        }
        let source = if none {
            None
        } else {
            Some(self.column(value)?)
        };
        let beside = every(beside.iter().map(|e| self.column(e)))?;
        Some(DataEntry {
            signal,
            span: name.span,
            source,
            beside,
        })
    }

    /// Arithmetic on columns.
    fn column(&mut self, e: &Ast) -> Option<ColumnExpr> {
        let kind = match &e.kind {
            ExprKind::Number(x) => ColumnKind::Number(*x),
            ExprKind::Share(x) => return self.fail(errors::share_elsewhere(e.span, *x)),
            ExprKind::Text(text) => ColumnKind::Column(text.trim().to_string()),
            ExprKind::Name(text) => ColumnKind::Number(self.number_in_data(e, text)?),
            ExprKind::Group(x) => self.column(x)?.kind,
            ExprKind::Negate(x) => ColumnKind::Negate(Box::new(self.column(x)?)),
            ExprKind::Sum(parts) => {
                self.within_limit(e, parts.len())?;
                return self.fold(parts, |sign, a, b| match sign {
                    Sign::Plus => ColumnKind::Add(a, b),
                    Sign::Minus => ColumnKind::Subtract(a, b),
                });
            }
            ExprKind::Product(parts) => {
                self.within_limit(e, parts.len())?;
                return self.fold(parts, |side, a, b| match side {
                    Side::Above => ColumnKind::Multiply(a, b),
                    Side::Below => ColumnKind::Divide(a, b),
                });
            }
            ExprKind::Power(base, exponent) => {
                let (base, p) = (self.column(base), self.constant(exponent, "an exponent"));
                ColumnKind::Power(Box::new(base?), p?)
            }
            ExprKind::Call(call) => self.column_call(e, call)?,
            ExprKind::Indexed(name, index) => return self.stray_index(e, name, index),
            ExprKind::List(_) | ExprKind::Range(..) => {
                return self.fail(errors::library_in_data(e.span));
            }
        };
        Some(ColumnExpr { span: e.span, kind })
    }

    fn within_limit(&mut self, e: &Ast, parts: usize) -> Option<()> {
        if parts > MODEL.column_chain {
            let help = "write such a column into the file";
            return self.fail(errors::chain_too_long(e.span, MODEL.column_chain, help));
        }
        Some(())
    }

    fn fold<Op: Copy>(
        &mut self,
        parts: &[(Op, Ast)],
        join: impl Fn(Op, Box<ColumnExpr>, Box<ColumnExpr>) -> ColumnKind,
    ) -> Option<ColumnExpr> {
        let mut out: Option<ColumnExpr> = None;
        for (op, part) in parts {
            let part = self.column(part)?;
            out = Some(match out {
                None => part,
                Some(left) => ColumnExpr {
                    span: left.span.to(part.span),
                    kind: join(*op, Box::new(left), Box::new(part)),
                },
            });
        }
        out
    }

    /// A bare name stands for a number; a column is quoted.
    fn number_in_data(&mut self, e: &Ast, text: &str) -> Option<f64> {
        use crate::check::scope::Value;
        if text == "pi" {
            return Some(std::f64::consts::PI);
        }
        self.scope.used_lets.insert(text.to_string());
        match self.scope.lets.get(text).map(|l| &l.value) {
            Some(Value::Number(x)) => Some(*x),
            Some(Value::Wrong) => None,
            _ if self.scope.may_be_declared(text) => None,
            _ => self.fail(errors::unquoted_column(e.span, text)),
        }
    }

    fn column_call(&mut self, e: &Ast, call: &Call) -> Option<ColumnKind> {
        let name = call.name.text.as_str();
        if let Some(f) = self.functions.get(name) {
            let (body, definition, params) = (f.body, f.span, f.params);
            self.used_functions.insert(name.to_string());
            let mut edits = Vec::new();
            for (param, x) in params.iter().zip(&call.args) {
                let text = match is_atom(x) {
                    true => self.text(x.span).to_string(),
                    false => format!("({})", self.text(x.span)),
                };
                let places = body.places_of(&param.text).into_iter();
                edits.extend(places.map(|at| (at, text.clone())));
            }
            let ours = self.file.edited(body.span, edits);
            let at = (call.name.span, e.span);
            return self.fail(errors::own_function_in_data(at, &ours, definition));
        }
        if call.juxtaposed || call.power.is_some() || call.numbers.is_some() {
            let given = call.args.first().map(|x| self.text(x.span));
            let column = given.filter(|x| x.starts_with('"')).unwrap_or("\"Column\"");
            return self.fail(errors::form(e.span, name, &format!("{name}({column})")));
        }
        if name == "unwrap" {
            return self.unwrap_call(e, call);
        }
        let Some(f) = self.function_named(name) else {
            return self.fail(errors::unknown_function(
                call.name.span,
                name,
                crate::diagnostic::did_you_mean(
                    name,
                    crate::term::FUNCTIONS
                        .iter()
                        .map(|f| f.name)
                        .chain(["unwrap"]),
                )
                .map(str::to_string),
                &[],
            ));
        };
        let args = every(call.args.iter().map(|a| self.column(a)))?;
        if args.len() < f.arity.0 || args.len() > f.arity.1 {
            let ours = self.call_of(call, f.arity, "\"Column\"");
            let found = (f.name, args.len());
            return self.fail(errors::arity(e.span, found, f.arity, &ours));
        }
        Some(ColumnKind::Call(f, args))
    }

    /// `unwrap("Angle", 2*pi)`
    fn unwrap_call(&mut self, e: &Ast, call: &Call) -> Option<ColumnKind> {
        let [column, period] = call.args.as_slice() else {
            let given = call.args.first();
            let column = given.map_or("\"Angle\"", |x| self.text(x.span));
            let ours = format!("unwrap({column}, 2*pi)");
            return self.fail(errors::form(e.span, "unwrap", &ours));
        };
        let (column, p) = (self.column(column), self.constant(period, "the period"));
        let (column, p) = (column?, p?);
        if p > 0.0 {
            return Some(ColumnKind::Unwrap(Box::new(column), p));
        }
        self.fail(errors::period(period.span, p))
    }
}
