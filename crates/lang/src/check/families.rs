//! Families of equations, `dx[i] ~ <x[i-1], x[i]>, i = 1..10`: written out, one equation for each value of the index.
//!
//! In: a parsed file. Out: the file without families, and their errors. Expanded equations keep the places of the text that they come from.
//! An index beyond the declared names is an error, unless the range is cyclic; names are looked up for such errors, and
//! for an index that is called like a variable.

use std::collections::BTreeSet;

use crate::ast::{
    Expr, ExprKind, File, Ident, IndexRange, Side, Sign, Statement, StatementKind, unknown_groups,
};
use crate::check::errors;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::thresholds::MODEL;

/// The file with every family written out, and the errors of those that could not be; `None` if there are none.
pub fn expand_families(file: &File) -> Option<(File, Vec<Diagnostic>)> {
    let is_family = |s: &Statement| matches!(s.kind, StatementKind::Family { .. });
    if !file.statements.iter().any(is_family) {
        return None;
    }
    let pass = Pass {
        file,
        declared: declared(file),
    };
    let (mut out, mut found, mut nodes) = (file.clone(), Vec::new(), 0usize);
    out.statements.clear();
    for s in &file.statements {
        let StatementKind::Family { statement, over } = &s.kind else {
            out.statements.push(s.clone());
            continue;
        };
        let mut kind = statement.as_ref().clone();
        let size: usize = kind.expressions_mut().iter().map(|e| size(e)).sum();
        let written = pass.values(statement, over).and_then(|range| {
            let count = range.1 - range.0 + 1;
            nodes = nodes.saturating_add(size.saturating_mul(count as usize));
            if nodes > MODEL.model_nodes {
                return Err(errors::model_too_large(s.span, MODEL.model_nodes));
            }
            (range.0..=range.1)
                .map(|value| pass.member(s, value, range))
                .collect::<Result<Vec<Statement>, Diagnostic>>()
        });
        match written {
            Ok(all) => out.statements.extend(all),
            Err(d) => {
                found.push(d);
                // Marked as broken, so that its equations are not reported as missing too.
                out.broken.push(crate::ast::Broken {
                    keyword: None,
                    names: Vec::new(),
                    span: s.span,
                });
            }
        }
    }
    Some((out, found))
}

/// Names from declarations and `let`s, with ranges written out.
fn declared(file: &File) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for s in &file.statements {
        match &s.kind {
            StatementKind::Declare { names, .. } => {
                for name in names {
                    match &name.kind {
                        ExprKind::Name(text) => drop(all.insert(text.clone())),
                        ExprKind::Range(from, to) => all.extend(range_of_names(from, to)),
                        _ => {}
                    }
                }
            }
            StatementKind::Unknown {
                names,
                range,
                attributes,
            } => {
                let groups = unknown_groups(names, range.as_ref(), attributes);
                all.extend(groups.iter().flat_map(|g| &g.names).map(|n| n.text.clone()))
            }
            StatementKind::Let { name, .. } => drop(all.insert(name.text.clone())),
            _ => {}
        }
    }
    all
}

/// The names of `x1..x12`; empty if it is not a range of names.
fn range_of_names(from: &Expr, to: &Expr) -> Vec<String> {
    let split = |e: &Expr| {
        let name = e.as_name()?;
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = name.get(stem.len()..)?.to_string();
        Some((stem.to_string(), digits.parse::<usize>().ok()?, digits))
    };
    let (Some((stem, first, digits)), Some((_, last, _))) = (split(from), split(to)) else {
        return Vec::new();
    };
    let width = if digits.starts_with('0') {
        digits.len()
    } else {
        1
    };
    let last = last.min(first.saturating_add(MODEL.range));
    (first..=last)
        .map(|i| format!("{stem}{i:0width$}"))
        .collect()
}

fn size(e: &Expr) -> usize {
    1 + e.children().into_iter().map(size).sum::<usize>()
}

struct Pass<'a> {
    file: &'a File,
    declared: BTreeSet<String>,
}

/// One value of the index in one family.
struct Member<'a> {
    over: &'a IndexRange,
    value: i64,
    range: (i64, i64),
}

impl Pass<'_> {
    /// The first and last value of an index.
    fn values(
        &self,
        statement: &StatementKind,
        over: &IndexRange,
    ) -> Result<(i64, i64), Diagnostic> {
        if self.declared.contains(&over.name.text) {
            return Err(errors::index_declared(
                over.name.span,
                &over.name.text,
                &self.free_index(),
            ));
        }
        let whole = |e: &Expr, last: bool| {
            let value = self.number(e, None, 0);
            value.ok_or_else(|| errors::index_end(e.span, self.declared_end(statement, last)))
        };
        let (from, to) = (whole(&over.from, false)?, whole(&over.to, true)?);
        let at = over.from.span.to(over.to.span);
        if from < 0 || from > to || to - from >= MODEL.range as i64 {
            return Err(errors::index_ends(at, from, to, MODEL.range));
        }
        Ok((from, to))
    }

    /// The greatest or least number among the declared names that the statement indexes.
    fn declared_end(&self, statement: &StatementKind, last: bool) -> Option<usize> {
        let indexed = |e: &Expr| matches!(e.kind, ExprKind::Indexed(..));
        let mut kind = statement.clone();
        let expressions = kind.expressions_mut().into_iter();
        let found: Vec<String> = expressions
            .filter_map(|e| match &e.find(&indexed)?.kind {
                ExprKind::Indexed(name, _) => Some(name.text.clone()),
                _ => None,
            })
            .collect();
        let stem = found.first()?.as_str();
        let number = |n: &String| n.strip_prefix(stem)?.parse::<usize>().ok();
        let numbers = self.declared.iter().filter_map(number);
        if last { numbers.max() } else { numbers.min() }
    }

    /// An unused name for an index.
    fn free_index(&self) -> String {
        let usual = ["i", "j", "k", "m", "n"].map(str::to_string);
        let more = (0..).map(|k| format!("i_{k}"));
        let mut all = usual.into_iter().chain(more);
        all.find(|n| !self.declared.contains(n)).unwrap_or_default()
    }

    /// The value of an expression of numbers, plain `let`s and the index, if it is a whole number.
    fn number(&self, e: &Expr, index: Option<(&str, i64)>, depth: usize) -> Option<i64> {
        let inner = |x: &Expr| self.number(x, index, depth);
        match &e.kind {
            ExprKind::Number(x) if x.fract() == 0.0 && x.abs() < 1e9 => Some(*x as i64),
            ExprKind::Group(x) => inner(x),
            ExprKind::Negate(x) => inner(x)?.checked_neg(),
            ExprKind::Sum(parts) => parts.iter().try_fold(0i64, |sum, (sign, x)| match sign {
                Sign::Plus => sum.checked_add(inner(x)?),
                Sign::Minus => sum.checked_sub(inner(x)?),
            }),
            ExprKind::Product(parts) => parts.iter().try_fold(1i64, |product, (side, x)| {
                let x = inner(x)?;
                match side {
                    Side::Above => product.checked_mul(x),
                    Side::Below => (x != 0 && product % x == 0).then(|| product / x),
                }
            }),
            ExprKind::Name(text) => match index {
                Some((name, value)) if name == text => Some(value),
                _ if depth > 3 => None,
                _ => self.file.statements.iter().find_map(|s| match &s.kind {
                    StatementKind::Let { name, body } if name.text == *text => {
                        self.number(body, None, depth + 1)
                    }
                    _ => None,
                }),
            },
            _ => None,
        }
    }

    /// The statement for one value of the index.
    fn member(
        &self,
        s: &Statement,
        value: i64,
        range: (i64, i64),
    ) -> Result<Statement, Diagnostic> {
        let StatementKind::Family { statement, over } = &s.kind else {
            return Ok(s.clone());
        };
        let member = Member { over, value, range };
        let (mut kind, mut edits) = (statement.as_ref().clone(), Vec::new());
        let mut whole: Option<Span> = None;
        for e in kind.expressions_mut() {
            whole = Some(whole.map_or(e.span, |w| w.to(e.span)));
            self.write(e, &member, &mut edits)?;
        }
        if let StatementKind::Equation { written, .. } = &mut kind {
            *written = whole.map(|whole| self.file.edited(whole, edits));
        }
        Ok(Statement { span: s.span, kind })
    }

    /// Replaces indexed names by plain ones, and the index by its value.
    fn write(
        &self,
        e: &mut Expr,
        member: &Member,
        edits: &mut Vec<(Span, String)>,
    ) -> Result<(), Diagnostic> {
        let span = e.span;
        match &mut e.kind {
            ExprKind::Indexed(name, index) => {
                let name = self.indexed(span, name, index, member)?;
                edits.push((span, name.clone()));
                e.kind = ExprKind::Name(name);
                Ok(())
            }
            ExprKind::Name(text) if *text == member.over.name.text => {
                edits.push((span, member.value.to_string()));
                e.kind = ExprKind::Number(member.value as f64);
                Ok(())
            }
            _ => {
                let mut parts = e.children_mut().into_iter();
                parts.try_for_each(|x| self.write(x, member, edits))
            }
        }
    }

    /// `x[i + 1]` with i = 2 is `x3`.
    fn indexed(
        &self,
        span: Span,
        name: &Ident,
        index: &Expr,
        member: &Member,
    ) -> Result<String, Diagnostic> {
        let over = (member.over.name.text.as_str(), member.value);
        let Some(at) = self.number(index, Some(over), 0) else {
            return Err(errors::index_not_whole(index.span, over.0));
        };
        let (from, to) = member.range;
        let at = match member.over.cyclic {
            true => from + (at - from).rem_euclid(to - from + 1),
            false => at,
        };
        let stem = name.text.trim_end_matches('\'');
        let primes = name.text.get(stem.len()..).unwrap_or("");
        let spelt = |width: usize| format!("{stem}{at:0width$}");
        let known = (1..5)
            .map(spelt)
            .find(|name| at >= 0 && self.is_declared(name));
        match known {
            Some(known) => Ok(known + primes),
            None if at >= 0 && !self.is_family(stem) => Ok(spelt(1) + primes),
            None => {
                let wanted = match at < 0 {
                    true => format!("{stem}[{at}]"),
                    false => spelt(1),
                };
                Err(errors::index_beyond(span, &wanted, over, member.over.span))
            }
        }
    }

    /// Whether a name, or the variable that it is a derivative of, is declared.
    fn is_declared(&self, name: &str) -> bool {
        let letters = name.len() - name.trim_start_matches('d').len();
        (0..=letters).any(|k| name.get(k..).is_some_and(|n| self.declared.contains(n)))
    }

    /// Whether the stem with some number is a declared name.
    fn is_family(&self, stem: &str) -> bool {
        let letters = stem.len() - stem.trim_start_matches('d').len();
        let numbered = |stem: &str| {
            let from = self.declared.range(stem.to_string()..);
            let mut own = from.take_while(|n| n.starts_with(stem));
            own.any(|n| {
                let digits = n.get(stem.len()..).unwrap_or("");
                !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
            })
        };
        (0..=letters).any(|k| stem.get(k..).is_some_and(|s| !s.is_empty() && numbered(s)))
    }
}
