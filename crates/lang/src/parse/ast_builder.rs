//! The text of one statement → its node of the ast.
//!
//! In: the text and tokens of a statement whose brackets match. Out: the node with spans of the whole file, or the first error. Each
//! function quotes the rule of the grammar it reads. Cuts no statements.

mod resets;

use pest::Parser;
use pest::iterators::{Pair, Pairs};

use crate::ast::{
    Attribute, Call, EntryKind, Expr, ExprKind, Ident, Image, IndexRange, Keyword, StatementKind,
};
use crate::diagnostic::Diagnostic;
use crate::parse::grammar::{PRECEDENCE, Rule, SidParser};
use crate::parse::lexer::{Token, normalise};
use crate::parse::operands::{infix, number, percent, raised, range};
use crate::parse::{explain, syntax_errors};
use crate::source::{FileId, Span};
use crate::term::Func;

type Result<T> = std::result::Result<T, Box<Diagnostic>>;

pub fn statement(
    file: FileId,
    text: &str,
    tokens: &[Token],
    rule: Rule,
    keyword: Option<Keyword>,
) -> Result<StatementKind> {
    let (tree, mut inner) = read(file, text, tokens, rule, keyword)?;
    match rule {
        Rule::version => tree.version(inner),
        Rule::system => tree.system(inner),
        Rule::declare => tree.declare(inner, keyword.unwrap_or(Keyword::State)),
        Rule::unknown => tree.unknown(inner),
        Rule::constant => tree.constant(inner),
        Rule::function => tree.function(inner),
        Rule::constrain => tree.constrain(&mut inner),
        Rule::per_run => tree.per_run(&mut inner),
        Rule::family => tree.family(tree.equation(&mut inner)?, &mut inner),
        Rule::constrain_family => tree.family(tree.constrain(&mut inner)?, &mut inner),
        Rule::per_run_family => tree.family(tree.per_run(&mut inner)?, &mut inner),
        Rule::symmetry => tree.symmetry(inner),
        Rule::reset => tree.reset(inner),
        Rule::limit => tree.limit(inner),
        Rule::prefer => tree.prefer(inner),
        Rule::include => tree.include(inner),
        _ => tree.equation(&mut inner),
    }
}

/// `step = { SOI ~ "step" ~ expr ~ EOI }` or `source = { SOI ~ name ~ "=" ~ expr ~ ("," ~ expr)* ~ EOI }`
pub fn entry(file: FileId, text: &str, tokens: &[Token]) -> Result<EntryKind> {
    let is_step = tokens.first().is_some_and(|t| t.text == "step")
        && tokens.get(1).is_some_and(|t| !t.is("="));
    let rule = if is_step { Rule::step } else { Rule::source };
    let (tree, mut inner) = read(file, text, tokens, rule, None)?;
    if is_step {
        return Ok(EntryKind::Step(tree.expr(tree.next(&mut inner)?)?));
    }
    let name = tree.ident(&tree.next(&mut inner)?);
    let value = tree.expr(tree.next(&mut inner)?)?;
    let beside = inner.filter(|pair| pair.as_rule() == Rule::expr);
    let beside: Result<Vec<Expr>> = beside.map(|pair| tree.expr(pair)).collect();
    Ok(EntryKind::Source {
        name,
        value,
        beside: beside?,
    })
}

/// Parses the text of a statement by one rule of the grammar.
fn read<'t>(
    file: FileId,
    text: &'t str,
    tokens: &[Token],
    rule: Rule,
    keyword: Option<Keyword>,
) -> Result<(AstBuilder<'t>, Pairs<'t, Rule>)> {
    let start = tokens.first().map_or(0, |t| t.start);
    let end = tokens.last().map_or(start, |t| t.end);
    let source = text.get(start..end).unwrap_or("");
    let tree = AstBuilder {
        file,
        text,
        start,
        end,
    };
    let at = (file, text, start);
    let refuse = |e| explain::explain(at, tokens, keyword, rule, &e);
    let mut pairs = SidParser::parse(rule, source).map_err(refuse)?;
    let statement = tree.next(&mut pairs)?;
    Ok((tree, statement.into_inner()))
}

/// Builds the nodes of one statement from pest's pairs.
struct AstBuilder<'t> {
    file: FileId,
    text: &'t str,
    start: usize,
    end: usize,
}

impl AstBuilder<'_> {
    fn span(&self, pair: &Pair<Rule>) -> Span {
        let s = pair.as_span();
        Span::new(self.file, self.start + s.start(), self.start + s.end())
    }

    /// The next part of a rule.
    ///
    /// # Errors
    /// An internal one: the grammar guarantees the part.
    fn next<'p>(&self, pairs: &mut Pairs<'p, Rule>) -> Result<Pair<'p, Rule>> {
        pairs.next().ok_or_else(|| {
            Box::new(syntax_errors::internal(Span::new(
                self.file, self.start, self.end,
            )))
        })
    }

    fn text(&self, span: Span) -> &str {
        self.text.get(span.start..span.end).unwrap_or("")
    }

    fn ident(&self, pair: &Pair<Rule>) -> Ident {
        Ident {
            text: normalise(pair.as_str()),
            span: self.span(pair),
        }
    }

    /// `version = { SOI ~ "sidc" ~ number ~ EOI }`
    fn version(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        Ok(StatementKind::Version(number(&self.next(&mut inner)?)))
    }

    /// `system = { SOI ~ "system" ~ word ~ EOI }`
    fn system(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        Ok(StatementKind::System(self.ident(&self.next(&mut inner)?)))
    }

    /// `declare = { SOI ~ kind ~ names ~ (":" ~ attribute ~ ("," ~ attribute)*)? ~ EOI }`
    fn declare(&self, inner: Pairs<Rule>, keyword: Keyword) -> Result<StatementKind> {
        let (mut names, mut attributes) = (Vec::new(), Vec::new());
        for pair in inner {
            match pair.as_rule() {
                Rule::names => names = self.items(pair)?,
                Rule::attribute => attributes.push(self.attribute(pair)?),
                _ => {}
            }
        }
        Ok(StatementKind::Declare {
            keyword,
            names,
            attributes,
        })
    }

    /// `unknown = { SOI ~ "unknown" ~ word … ~ within? ~ (… ~ attribute …)? ~ EOI }`
    fn unknown(&self, inner: Pairs<Rule>) -> Result<StatementKind> {
        let (mut names, mut range, mut attributes) = (Vec::new(), None, Vec::new());
        for pair in inner {
            match pair.as_rule() {
                Rule::word => names.push(self.ident(&pair)),
                Rule::within => range = Some(self.within(pair)?),
                Rule::attribute => attributes.push(self.attribute(pair)?),
                _ => {}
            }
        }
        Ok(StatementKind::Unknown {
            names,
            range,
            attributes,
        })
    }

    /// `attribute = { word ~ (within | expr)? }`
    fn attribute(&self, pair: Pair<Rule>) -> Result<Attribute> {
        let mut inner = pair.into_inner();
        let key = self.ident(&self.next(&mut inner)?);
        let value = inner.next().map(|value| match value.as_rule() {
            Rule::within => self.within(value),
            _ => self.expr(value),
        });
        let value = value.transpose()?;
        Ok(Attribute { key, value })
    }

    /// `within = { inside ~ expr ~ ".." ~ expr }`
    fn within(&self, pair: Pair<Rule>) -> Result<Expr> {
        let mut ends = pair.into_inner();
        self.next(&mut ends)?;
        let from = self.expr(self.next(&mut ends)?)?;
        let to = self.expr(self.next(&mut ends)?)?;
        Ok(range(from, to))
    }

    /// `constant = { SOI ~ "let" ~ word ~ "=" ~ expr ~ EOI }`
    fn constant(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        Ok(StatementKind::Let {
            name: self.ident(&self.next(&mut inner)?),
            body: self.expr(self.next(&mut inner)?)?,
        })
    }

    /// `function = { SOI ~ "let" ~ word ~ "(" ~ word ~ ("," ~ word)* ~ ")" ~ "=" ~ expr ~ EOI }`
    fn function(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        let name = self.ident(&self.next(&mut inner)?);
        let mut params = Vec::new();
        let mut part = self.next(&mut inner)?;
        while part.as_rule() == Rule::word {
            params.push(self.ident(&part));
            part = self.next(&mut inner)?;
        }
        let body = self.expr(part)?;
        Ok(StatementKind::Function { name, params, body })
    }

    /// `equation = { SOI ~ names ~ relates ~ expr ~ EOI }`
    fn equation(&self, inner: &mut Pairs<Rule>) -> Result<StatementKind> {
        let targets = self.items(self.next(inner)?)?;
        let known = self.next(inner)?.as_str() == "=";
        let right = self.expr(self.next(inner)?)?;
        Ok(StatementKind::Equation {
            targets,
            known,
            right,
            written: None,
        })
    }

    /// `over = { word ~ "=" ~ end ~ ".." ~ end ~ cyclic? }`, the last part of a family
    fn family(&self, statement: StatementKind, inner: &mut Pairs<Rule>) -> Result<StatementKind> {
        let over = self.next(inner)?;
        let span = self.span(&over);
        let mut parts = over.into_inner();
        let name = self.ident(&self.next(&mut parts)?);
        let mut end = || -> Result<Expr> {
            let end = self.next(&mut parts)?;
            self.primary(self.next(&mut end.into_inner())?)
        };
        let (from, to) = (end()?, end()?);
        let over = IndexRange {
            span,
            name,
            from,
            to,
            cyclic: parts.next().is_some(),
        };
        Ok(StatementKind::Family {
            statement: Box::new(statement),
            over: Box::new(over),
        })
    }

    /// `constrain = { SOI ~ "constrain" ~ expr ~ (relation ~ expr)+ ~ EOI }`
    fn constrain(&self, inner: &mut Pairs<Rule>) -> Result<StatementKind> {
        let first = self.expr(self.next(inner)?)?;
        let mut rest = Vec::new();
        while let Some(pair) = inner.peek().filter(|p| p.as_rule() == Rule::relation) {
            inner.next();
            rest.push((relation(&pair), self.expr(self.next(inner)?)?));
        }
        Ok(StatementKind::Constrain { first, rest })
    }

    /// `per_run = { SOI ~ "constrain"? ~ names ~ ":" ~ attribute ~ EOI }`
    fn per_run(&self, inner: &mut Pairs<Rule>) -> Result<StatementKind> {
        Ok(StatementKind::PerRun {
            coefficients: self.items(self.next(inner)?)?,
            attribute: self.attribute(self.next(inner)?)?,
        })
    }

    /// `symmetry = { SOI ~ "symmetry" ~ ("(" ~ names ~ ")" ~ "->" | names ~ "->") ~ image ~ EOI }`, `image = { flipped | names }`
    fn symmetry(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        let names = self.items(self.next(&mut inner)?)?;
        let image = self.next(&mut inner)?;
        let span = self.span(&image);
        let mut items = self.next(&mut image.into_inner())?;
        let flipped = items.as_rule() == Rule::flipped;
        if flipped {
            items = self.next(&mut items.into_inner())?;
        }
        let image = Image {
            span,
            flipped,
            items: self.items(items)?,
        };
        Ok(StatementKind::Symmetry { names, image })
    }

    /// `limit = { SOI ~ "limit" ~ attribute ~ ("," ~ attribute)* ~ EOI }`
    fn limit(&self, inner: Pairs<Rule>) -> Result<StatementKind> {
        let keys = inner.filter(|p| p.as_rule() == Rule::attribute);
        let keys: Result<Vec<Attribute>> = keys.map(|p| self.attribute(p)).collect();
        Ok(StatementKind::Limit(keys?))
    }

    /// `prefer = { SOI ~ "prefer" ~ attribute ~ EOI }`
    fn prefer(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        let key = self.attribute(self.next(&mut inner)?)?;
        Ok(StatementKind::Prefer(key))
    }

    /// `include = { SOI ~ "include" ~ text ~ EOI }`
    fn include(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        let text = self.next(&mut inner)?;
        let path = text.as_str().trim_matches('"').to_string();
        let at = self.span(&text);
        Ok(StatementKind::Include { path, at })
    }

    /// `items = { item ~ ("," ~ item)* ~ ","? }`, and likewise `names` and `numbers`
    fn items(&self, pair: Pair<Rule>) -> Result<Vec<Expr>> {
        pair.into_inner().map(|p| self.item(p)).collect()
    }

    /// `item = { expr ~ (".." ~ expr)? }`
    fn item(&self, pair: Pair<Rule>) -> Result<Expr> {
        let mut inner = pair.into_inner();
        let from = self.expr(self.next(&mut inner)?)?;
        match inner.next() {
            None => Ok(from),
            Some(to) => Ok(range(from, self.expr(to)?)),
        }
    }

    /// `expr = { operand ~ ((add | subtract | multiply | divide) ~ operand)* }`
    fn expr(&self, pair: Pair<Rule>) -> Result<Expr> {
        let mut inner = pair.into_inner();
        if inner.len() == 1 {
            // Most expressions are one name or number.
            return self.primary(self.next(&mut inner)?);
        }
        PRECEDENCE
            .map_primary(|p| self.primary(p))
            .map_prefix(|op, e| {
                let e = e?;
                let span = self.span(&op).to(e.span);
                Ok(Expr::new(span, ExprKind::Negate(Box::new(e))))
            })
            .map_postfix(|base, op| self.power(base?, op))
            .map_infix(|left, op, right| Ok(infix(left?, op.as_rule(), right?)))
            .parse(inner)
    }

    /// `power = { "^" ~ exponent }`, `exponent = { minus? ~ (number | word | group) }`
    fn power(&self, base: Expr, op: Pair<Rule>) -> Result<Expr> {
        let exponent = self.next(&mut op.into_inner())?;
        let mut parts = exponent.into_inner();
        let first = self.next(&mut parts)?;
        let exponent = match parts.next() {
            Some(value) => {
                let value = self.primary(value)?;
                let span = self.span(&first).to(value.span);
                Expr::new(span, ExprKind::Negate(Box::new(value)))
            }
            None => self.primary(first)?,
        };
        let span = base.span.to(exponent.span);
        match &base.kind {
            ExprKind::Power(x, p) => Err(Box::new(syntax_errors::double_power(
                span,
                self.text(x.span),
                self.text(p.span),
                self.text(exponent.span),
            ))),
            ExprKind::Call(call) if call.juxtaposed && Func::named(&call.name.text).is_some() => {
                let f = &call.name.text;
                let x = call.args.first().map_or("x", |a| self.text(a.span));
                let p = self.text(exponent.span);
                let readings = [format!("{f}({x})^{p}"), format!("{f}({x}^{p})")];
                Err(Box::new(syntax_errors::ambiguous_argument(
                    span, f, &readings,
                )))
            }
            _ => Ok(Expr::new(
                span,
                ExprKind::Power(Box::new(base), Box::new(exponent)),
            )),
        }
    }

    /// `primary = _{ share | number | reference | list | group | text }`
    fn primary(&self, pair: Pair<Rule>) -> Result<Expr> {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::reference => return self.reference(pair),
            Rule::number => ExprKind::Number(number(&pair)),
            Rule::share => ExprKind::Share(percent(&pair)),
            Rule::text => ExprKind::Text(pair.as_str().trim_matches('"').to_string()),
            Rule::list => ExprKind::List(self.items(self.next(&mut pair.into_inner())?)?),
            Rule::group => {
                let inner = self.next(&mut pair.into_inner())?;
                ExprKind::Group(Box::new(self.expr(inner)?))
            }
            _ => ExprKind::Name(normalise(pair.as_str())),
        };
        Ok(Expr::new(span, kind))
    }

    /// `reference = { name ~ (index | arguments | applied)? }`
    fn reference(&self, pair: Pair<Rule>) -> Result<Expr> {
        let mut inner = pair.into_inner();
        let name = self.ident(&self.next(&mut inner)?);
        match inner.next() {
            None => Ok(Expr::new(name.span, ExprKind::Name(name.text))),
            Some(rest) if rest.as_rule() == Rule::index => {
                let span = name.span.to(self.span(&rest));
                let index = self.expr(self.next(&mut rest.into_inner())?)?;
                Ok(Expr::new(span, ExprKind::Indexed(name, Box::new(index))))
            }
            Some(rest) => {
                let span = name.span.to(self.span(&rest));
                Ok(Expr::new(span, ExprKind::Call(self.call(name, rest)?)))
            }
        }
    }

    /// `arguments = { raised? ~ "(" ~ items? ~ (";" ~ numbers)? ~ ")" }`, `applied = { raised? ~ name }`
    fn call(&self, name: Ident, rest: Pair<Rule>) -> Result<Call> {
        let mut call = Call {
            name,
            power: None,
            args: Vec::new(),
            numbers: None,
            juxtaposed: rest.as_rule() == Rule::applied,
        };
        for part in rest.into_inner() {
            let span = self.span(&part);
            match part.as_rule() {
                Rule::raised => call.power = Some((raised(part), span)),
                Rule::items => call.args = self.items(part)?,
                Rule::numbers => call.numbers = Some(self.items(part)?),
                _ => call.args = vec![self.primary(part)?],
            }
        }
        Ok(call)
    }
}

fn relation(pair: &Pair<Rule>) -> &'static str {
    let all = ["<=", ">=", "<", ">"];
    let written = all.into_iter().find(|r| *r == pair.as_str());
    written.unwrap_or("=")
}
