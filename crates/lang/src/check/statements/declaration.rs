//! `state`, `input`, `output`, `param`: the variables of a model and the names they make.
//!
//! In: declarations. Out: variables in order of declaration, and every name that they make. Name clashes are reported with both places.

use crate::ast::{
    ATTRIBUTES, Attribute, Expr, ExprKind, Keyword, Sign, StatementKind, unknown_groups,
};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::model::{Between, Delay, Var, VarKind};
use crate::sensor_noise::SensorNoise;
use crate::source::Span;
use crate::term::{Signal, VarId};
use crate::thresholds::MODEL;
use crate::units;
use crate::units::Unit;

/// An example of a noise, for messages.
const NOISE: &str = "0.01";

/// What the attributes of one statement say.
struct Attributes {
    order: u8,
    noise: Option<SensorNoise>,
    memory: Option<f64>,
    unit: Option<Unit>,
    between: Option<Between>,
    delay: Option<Delay>,
    /// Where the state is declared to be hidden.
    hidden: Option<Span>,
}

impl Checker<'_> {
    pub fn declarations(&mut self) {
        self.scope.vars.push(Var {
            name: "t".to_string(),
            kind: VarKind::Time,
            order: 0,
            noise: Default::default(),
            noise_time_constant: None,
            unit: None,
            between: None,
            delay: None,
            hidden: false,
            span: None,
        });
        self.scope.signals.insert("t".to_string(), Signal::TIME);
        self.scope.broken_names = self
            .file
            .broken
            .iter()
            .flat_map(|b| b.names.iter().cloned())
            .collect();
        let broken = &mut self.file.broken.iter();
        self.scope.incomplete = broken.any(|b| b.keyword == Some(Keyword::Include));
        for s in self.statements() {
            if let StatementKind::Declare {
                keyword,
                names,
                attributes,
            } = &s.kind
            {
                self.declare(*keyword, names, attributes);
            } else if let StatementKind::Unknown {
                names,
                range,
                attributes,
            } = &s.kind
            {
                for group in unknown_groups(names, range.as_ref(), attributes) {
                    self.declare_unknown(&group);
                }
            }
        }
        // Time has a unit only in a model with units.
        if self.scope.vars.iter().any(|v| v.unit.is_some())
            && let Some(time) = self.scope.vars.first_mut()
        {
            time.unit.get_or_insert_with(Unit::second);
        }
    }

    fn declare(&mut self, keyword: Keyword, names: &[Expr], attributes: &[Attribute]) {
        let kind = match keyword {
            Keyword::Input => VarKind::Input,
            Keyword::Output => VarKind::Output,
            Keyword::Param => VarKind::Param,
            _ => VarKind::State,
        };
        let declared: Vec<(String, Span)> = names
            .iter()
            .filter_map(|n| self.declared_names(n, keyword))
            .flatten()
            .collect();
        let a = self.attributes(keyword, attributes);
        if let ([(name, span)], Some(unit), [_]) = (declared.as_slice(), &a.unit, attributes)
            && (name == "t" && keyword == Keyword::Input)
        {
            return self.declare_time(*span, unit.clone());
        }
        for (name, span) in declared {
            self.add_variable(Var {
                name,
                kind,
                order: a.order,
                noise: a.noise.map(|noise| (0, noise)).into_iter().collect(),
                noise_time_constant: a.memory,
                unit: a.unit.clone(),
                between: a.between,
                delay: a.delay,
                hidden: a.hidden.is_some(),
                span: Some(span),
            });
        }
    }

    /// `input t : unit "year"`, the only declaration of time.
    fn declare_time(&mut self, span: Span, unit: Unit) {
        let Some(time) = self.scope.vars.first_mut() else {
            return;
        };
        match time.span.replace(span) {
            Some(first) => self.say(errors::twice(span, first, "unit of time")),
            None => time.unit = Some(unit),
        }
    }

    /// One name, or a range `x1..x12`.
    fn declared_names(&mut self, e: &Expr, keyword: Keyword) -> Option<Vec<(String, Span)>> {
        match &e.kind {
            ExprKind::Name(text) if text.ends_with('\'') => {
                let base = text.trim_end_matches('\'');
                self.scope.broken_names.insert(base.to_string());
                self.fail(errors::declared_derivative(e.span, text))
            }
            ExprKind::Name(text) => Some(vec![(text.clone(), e.span)]),
            ExprKind::Range(from, to) => {
                let names = self.expand_range(e.span, from, to)?;
                Some(names.into_iter().map(|n| (n, e.span)).collect())
            }
            ExprKind::Call(call) if call.juxtaposed => {
                let second = call.args.first().and_then(Expr::as_name).unwrap_or("");
                let gap = call.args.first().map_or(e.span.end, |a| a.span.start);
                let gap = Span::new(e.span.file, call.name.span.end, gap);
                let d = errors::two_names(e.span, gap, keyword.text(), &call.name.text, second);
                self.scope.broken_names.insert(call.name.text.clone());
                self.scope.broken_names.insert(second.to_string());
                self.fail(d)
            }
            // `y(2)`: the number may have been meant as an order.
            ExprKind::Call(call) => {
                self.scope.broken_names.insert(call.name.text.clone());
                let names = [call.name.text.as_str()];
                self.fail(errors::not_a_name(e.span, keyword.text(), &names))
            }
            _ => {
                let children = e.children().into_iter();
                let names: Vec<&str> = children.filter_map(Expr::as_name).collect();
                self.fail(errors::not_a_name(e.span, keyword.text(), &names))
            }
        }
    }

    pub(super) fn add_variable(&mut self, var: Var) {
        let span = var.span;
        let at = span.unwrap_or(Span::new(self.file.id, 0, 0));
        if var.name == "t" || var.name == "pi" {
            return self.say(errors::taken(at, &var.name));
        }
        if self.scope.vars.len() > MODEL.variables {
            if self.reported.insert("\0variables".to_string()) {
                self.say(errors::too_many_variables(at, MODEL.variables));
            }
            return;
        }
        let id = VarId(self.scope.vars.len() as u16);
        for k in 0..=var.order {
            let name = "d".repeat(usize::from(k)) + &var.name;
            if let Some(other) = self.scope.signals.get(&name) {
                let other = self.scope.var(other.var).cloned();
                if let Some(other) = other {
                    let alone = self.text(at) == var.name;
                    self.say(errors::clash((at, alone), &var, k, &other));
                }
                if k == 0 {
                    return;
                }
            }
        }
        for k in 0..=var.order {
            let name = "d".repeat(usize::from(k)) + &var.name;
            self.scope
                .signals
                .entry(name)
                .or_insert(Signal::derivative(id, k));
        }
        self.scope.vars.push(var);
    }

    fn attributes(&mut self, keyword: Keyword, attributes: &[Attribute]) -> Attributes {
        let discrete = self.scope.discrete;
        let mut out = Attributes {
            order: u8::from(keyword == Keyword::State && discrete.is_none()),
            noise: None,
            memory: None,
            unit: None,
            between: None,
            delay: None,
            hidden: None,
        };
        for (i, a) in attributes.iter().enumerate() {
            let before = attributes.iter().take(i).find(|b| b.key.text == a.key.text);
            if let Some(first) = before {
                self.say(errors::twice(
                    a.key.span,
                    first.key.span,
                    &format!("`{}`", a.key.text),
                ));
                continue;
            }
            match a.key.text.as_str() {
                "order" if matches!(keyword, Keyword::State | Keyword::Input) => {
                    if let Some(order) = self.order(keyword, a) {
                        out.order = order;
                    }
                }
                "noise" if keyword != Keyword::Param => out.noise = self.noise(a),
                "memory" if keyword == Keyword::State => out.memory = self.memory(a),
                "unit" => out.unit = self.unit(a),
                key if keyword == Keyword::Input && Between::named(key).is_some() => {
                    self.between(a, &mut out.between);
                }
                "delay" if matches!(keyword, Keyword::State | Keyword::Input) => {
                    out.delay = self.delay(keyword, a);
                }
                "hidden" if keyword == Keyword::State => self.hidden(a, &mut out.hidden),
                key if ATTRIBUTES.contains(&key) => {
                    self.say(errors::attribute_elsewhere(a.key.span, key, keyword.text()));
                }
                key => {
                    let d = errors::unknown_attribute(a.key.span, key, &ATTRIBUTES);
                    self.say(d);
                }
            }
        }
        out
    }

    /// `hidden`
    fn hidden(&mut self, a: &Attribute, hidden: &mut Option<Span>) {
        match &a.value {
            Some(value) => self.say(errors::attribute_without_value(value.span, "hidden")),
            None => *hidden = Some(a.key.span),
        }
    }

    /// `order 2`
    fn order(&mut self, keyword: Keyword, a: &Attribute) -> Option<u8> {
        let least = u8::from(keyword == Keyword::State);
        let value = self.attribute_number(a, "2")?;
        if value.fract() != 0.0 || value < f64::from(least) || value > f64::from(MODEL.order) {
            let at = a.value.as_ref().map_or(a.key.span, |v| v.span);
            return self.fail(errors::order(at, value, least, MODEL.order));
        }
        match self.scope.discrete {
            Some(place) if value > f64::from(least) => {
                self.fail(errors::order_in_discrete(a.key.span, place))
            }
            Some(_) => Some(0),
            None => Some(value as u8),
        }
    }

    /// `noise 0.01`, `noise 2%`, `noise 0.01 + 2%`
    fn noise(&mut self, a: &Attribute) -> Option<SensorNoise> {
        let Some(value) = &a.value else {
            self.attribute_number(a, NOISE)?;
            return None;
        };
        let mut noise = SensorNoise::default();
        let parts = match &value.kind {
            ExprKind::Sum(parts) => parts.iter().collect(),
            _ => Vec::new(),
        };
        let shares = |e: &Expr| matches!(e.kind, ExprKind::Share(_));
        if parts.iter().any(|(_, e)| shares(e)) {
            for (sign, part) in parts {
                let (to, x) = match &part.kind {
                    ExprKind::Share(x) => (&mut noise.share, *x),
                    _ => (
                        &mut noise.floor,
                        self.early_number(part, &a.key.text, NOISE)?,
                    ),
                };
                // Each part may occur once, and only with a plus.
                let fits = *sign == Sign::Plus && *to == 0.0 && x > 0.0;
                *to = if fits { x } else { f64::NAN };
            }
        } else if let ExprKind::Share(x) = value.kind {
            noise.share = x;
        } else {
            noise.floor = self.early_number(value, &a.key.text, NOISE)?;
        }
        if noise.is_valid() {
            return Some(noise);
        }
        let text = self.text(value.span).to_string();
        self.fail(errors::noise(value.span, &text))
    }

    /// `memory 0.3`
    fn memory(&mut self, a: &Attribute) -> Option<f64> {
        if let Some(place) = self.scope.discrete {
            return self.fail(errors::memory_in_discrete(a.key.span, place));
        }
        let seconds = self.attribute_number(a, "0.3")?;
        if seconds >= 0.0 {
            return Some(seconds);
        }
        let at = a.value.as_ref().map_or(a.key.span, |v| v.span);
        self.fail(errors::negative_memory(at, seconds))
    }

    /// `delay 0.09` or `delay in 0 .. 0.2`
    fn delay(&mut self, keyword: Keyword, a: &Attribute) -> Option<Delay> {
        if let Some(place) = self.scope.discrete {
            return self.fail(errors::delay_in_discrete(a.key.span, place, keyword.text()));
        }
        let Some(value) = &a.value else {
            let wanted = "seconds, or a range of them";
            let examples = ["delay 0.09", "delay in 0 .. 0.2"];
            let at = (a.key.span, a.key.span);
            return self.fail(errors::attribute_value(at, "delay", wanted, &examples));
        };
        let ExprKind::Range(from, to) = &value.kind else {
            let seconds = self.early_number(value, "delay", "0.09")?;
            if seconds < 0.0 {
                return self.fail(errors::negative_delay(value.span, seconds));
            }
            return Some(Delay::Known(seconds));
        };
        let (first, last) = (
            self.early_number(from, "delay", "0"),
            self.early_number(to, "delay", "0.2"),
        );
        let (from, to) = (first?, last?);
        if from < to {
            return Some(Delay::Within { from, to });
        }
        self.fail(errors::empty_delay_range(value.span, from, to))
    }

    /// `unit "m"`
    pub(super) fn unit(&mut self, a: &Attribute) -> Option<Unit> {
        let Some((at, text)) = a.value.as_ref().and_then(|v| self.quoted(v)) else {
            let value = a.value.as_ref().map_or(a.key.span, |v| v.span);
            let bare = a.value.as_ref().map_or("m", |v| self.text(v.span));
            let example = format!("unit \"{bare}\"");
            let at = (a.key.span, a.key.span.to(value));
            let wanted = "a text in quotes";
            return self.fail(errors::attribute_value(at, "unit", wanted, &[&example]));
        };
        let place = |range: std::ops::Range<usize>| {
            Span::new(at.file, at.start + range.start, at.start + range.end)
        };
        match units::parse(text) {
            Ok((unit, misspellings)) => {
                for s in misspellings {
                    self.say(errors::unit_unknown(place(s.at.clone()), &s));
                }
                Some(unit)
            }
            Err(fault) => {
                let mended = Some(fault.suggestion.clone());
                let mended = mended.filter(|m| !m.is_empty() && units::parse(m).is_ok());
                let at = (place(fault.at.clone()), at);
                self.fail(errors::unit_text(at, &fault, mended))
            }
        }
    }

    /// The text between quotes, and its place.
    fn quoted(&self, e: &Expr) -> Option<(Span, &str)> {
        let ExprKind::Text(_) = e.kind else {
            return None;
        };
        let inner = Span::new(e.span.file, e.span.start + 1, e.span.end.checked_sub(1)?);
        Some((inner, self.text(inner)))
    }

    /// `hold`, `linear` or `cubic`
    fn between(&mut self, a: &Attribute, between: &mut Option<Between>) {
        if let Some(value) = &a.value {
            return self.say(errors::attribute_without_value(value.span, &a.key.text));
        }
        if let Some(before) = between {
            return self.say(errors::two_courses(a.key.span, before.word()));
        }
        *between = Between::named(&a.key.text);
    }

    fn attribute_number(&mut self, a: &Attribute, example: &str) -> Option<f64> {
        match &a.value {
            Some(value) => self.early_number(value, &a.key.text, example),
            None => {
                let (at, example) = (a.key.span, format!("{} {example}", a.key.text));
                let d = errors::attribute_value((at, at), &a.key.text, "a number", &[&example]);
                self.fail(d)
            }
        }
    }

    /// A number, in which only `let`s that are plain numbers may occur: declarations are checked before all other statements.
    fn early_number(&mut self, e: &Expr, key: &str, example: &str) -> Option<f64> {
        if let ExprKind::Text(text) = &e.kind {
            let said = text.split_whitespace().next().unwrap_or("");
            let example = said.parse::<f64>().map_or(example, |_| said);
            return self.fail(errors::attribute_text(e.span, key, example));
        }
        self.constant(e, &format!("`{key}`"))
    }
}
