//! Faults planted in the sources, each behind a number: one build holds them all.
//!
//! In: the text of a file. Out: the text with `crate::mutants::on(N)` at every fault, and what each fault is.

use std::collections::BTreeSet;

use proc_macro2::Span;
use quote::ToTokens;
use syn::spanned::Spanned;
use syn::visit_mut::{self, VisitMut};
use syn::{BinOp, Block, Expr, ReturnType, Signature, Stmt, Type, UnOp, parse_quote};

/// One fault.
pub struct Mutant {
    pub id: u32,
    pub line: usize,
    pub function: String,
    pub what: String,
}

/// Plants every fault of a file but those in `without`; numbers go on from `next`.
pub fn plant(text: &str, next: &mut u32, without: &BTreeSet<u32>) -> (String, Vec<Mutant>) {
    let mut file = syn::parse_file(text).expect("a source that compiles");
    let mut planter = Planter {
        next,
        without,
        functions: Vec::new(),
        found: Vec::new(),
    };
    planter.visit_file_mut(&mut file);
    (prettyplease::unparse(&file), planter.found)
}

struct Planter<'a> {
    next: &'a mut u32,
    without: &'a BTreeSet<u32>,
    functions: Vec<String>,
    found: Vec<Mutant>,
}

impl Planter<'_> {
    /// The switch of one more fault; `None` if it is not wanted.
    fn switch(&mut self, span: Span, what: impl Into<String>) -> Option<Expr> {
        *self.next += 1;
        let id = *self.next;
        if self.without.contains(&id) {
            return None;
        }
        self.found.push(Mutant {
            id,
            line: span.start().line,
            function: self.functions.last().cloned().unwrap_or_default(),
            what: what.into(),
        });
        Some(parse_quote!(crate::mutants::on(#id)))
    }

    fn body(&mut self, sig: &Signature, block: &mut Block, owner: &str) {
        if sig.constness.is_some() || sig.asyncness.is_some() || block.stmts.is_empty() {
            return;
        }
        let name = match owner {
            "" => sig.ident.to_string(),
            owner => format!("{owner}::{}", sig.ident),
        };
        self.functions.push(name);
        let alone = match block.stmts.as_slice() {
            [Stmt::Expr(e, None)] => e.to_token_stream().to_string(),
            _ => String::new(),
        };
        visit_mut::visit_block_mut(self, block);
        let mut first: Vec<Stmt> = Vec::new();
        let others = values_of(&sig.output).into_iter();
        for value in others.filter(|v| v.to_token_stream().to_string() != alone) {
            let what = format!("body -> {}", value.to_token_stream());
            if let Some(on) = self.switch(sig.ident.span(), what) {
                first.push(parse_quote!(if #on { return #value; }));
            }
        }
        block.stmts.splice(0..0, first);
        self.functions.pop();
    }

    fn binary(&mut self, e: &mut syn::ExprBinary) -> Option<Expr> {
        if holds_let(&e.left) || holds_let(&e.right) {
            return None;
        }
        let (l, r, op) = (&e.left, &e.right, e.op);
        let span = op.span();
        let name = op.to_token_stream().to_string();
        if matches!(op, BinOp::And(_) | BinOp::Or(_)) {
            let and = matches!(op, BinOp::And(_));
            let on = self.switch(span, format!("{name} -> {}", if and { "||" } else { "&&" }))?;
            return Some(match and {
                true => parse_quote!({ let l: bool = #l; if l != #on { #r } else { l } }),
                false => parse_quote!({ let l: bool = #l; if l == #on { #r } else { l } }),
            });
        }
        let others = others(&op);
        if others.is_empty() {
            return None;
        }
        let comparison = matches!(
            op,
            BinOp::Eq(_) | BinOp::Ne(_) | BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_)
        );
        let assigns = name.ends_with('=') && !comparison;
        let mut out: Expr = match (comparison, assigns) {
            (true, _) => parse_quote!(*l #op *r),
            (_, true) => parse_quote!(#l #op #r),
            _ => parse_quote!(l #op r),
        };
        let mut any = false;
        for other in others {
            let what = format!("{name} -> {}", other.to_token_stream());
            let Some(on) = self.switch(span, what) else {
                continue;
            };
            any = true;
            let mutated: Expr = match (comparison, assigns) {
                (true, _) => parse_quote!(*l #other *r),
                (_, true) => parse_quote!(#l #other #r),
                _ => parse_quote!(l #other r),
            };
            out = parse_quote!(if #on { #mutated } else { #out });
        }
        if !any {
            return None;
        }
        Some(match (comparison, assigns) {
            (true, _) => parse_quote!((match (&(#l), &(#r)) { (l, r) => #out })),
            (_, true) => parse_quote!((#out)),
            _ => parse_quote!((match (#l, #r) { (l, r) => #out })),
        })
    }

    fn unary(&mut self, e: &syn::ExprUnary) -> Option<Expr> {
        let (op, x) = (e.op, &e.expr);
        if matches!(op, UnOp::Deref(_)) || matches!(**x, Expr::Lit(_)) {
            return None;
        }
        let on = self.switch(op.span(), format!("delete {}", op.to_token_stream()))?;
        Some(parse_quote!((match #x { v => if #on { v } else { #op v } })))
    }
}

impl VisitMut for Planter<'_> {
    fn visit_item_mut(&mut self, item: &mut syn::Item) {
        let attributes = match item {
            syn::Item::Mod(m) => &m.attrs,
            syn::Item::Fn(f) => &f.attrs,
            syn::Item::Impl(i) => &i.attrs,
            syn::Item::Const(_) | syn::Item::Static(_) | syn::Item::Enum(_) => return,
            _ => &Vec::new(),
        };
        let test = |a: &syn::Attribute| a.to_token_stream().to_string().contains("test");
        if !attributes.iter().any(test) {
            visit_mut::visit_item_mut(self, item);
        }
    }

    fn visit_item_fn_mut(&mut self, f: &mut syn::ItemFn) {
        self.body(&f.sig, &mut f.block, "");
    }

    fn visit_item_impl_mut(&mut self, i: &mut syn::ItemImpl) {
        let owner = i.self_ty.to_token_stream().to_string().replace(' ', "");
        for item in &mut i.items {
            if let syn::ImplItem::Fn(f) = item {
                self.body(&f.sig, &mut f.block, &owner);
            }
        }
    }

    fn visit_item_trait_mut(&mut self, t: &mut syn::ItemTrait) {
        let owner = t.ident.to_string();
        for item in &mut t.items {
            if let syn::TraitItem::Fn(f) = item
                && let Some(block) = &mut f.default
            {
                self.body(&f.sig, block, &owner);
            }
        }
    }

    fn visit_type_mut(&mut self, _: &mut Type) {}
    fn visit_pat_mut(&mut self, _: &mut syn::Pat) {}
    fn visit_generic_argument_mut(&mut self, _: &mut syn::GenericArgument) {}

    fn visit_expr_repeat_mut(&mut self, e: &mut syn::ExprRepeat) {
        self.visit_expr_mut(&mut e.expr);
    }

    fn visit_expr_match_mut(&mut self, m: &mut syn::ExprMatch) {
        visit_mut::visit_expr_match_mut(self, m);
        let falls = |a: &syn::Arm| a.guard.is_none() && matches!(a.pat, syn::Pat::Wild(_));
        let falls = m.arms.iter().any(falls);
        for arm in &mut m.arms {
            let (span, pattern) = (arm.pat.span(), arm.pat.to_token_stream().to_string());
            let pattern: String = pattern.chars().take(60).collect();
            if let Some((_, guard)) = &mut arm.guard {
                if holds_let(guard) {
                    continue;
                }
                let always = self.switch(span, format!("guard of {pattern} -> true"));
                let never = self.switch(span, format!("guard of {pattern} -> false"));
                if let Some(on) = always {
                    **guard = parse_quote!(#on || #guard);
                }
                if let Some(on) = never {
                    **guard = parse_quote!(!#on && (#guard));
                }
            } else if falls
                && !matches!(arm.pat, syn::Pat::Wild(_))
                && let Some(on) = self.switch(span, format!("delete arm {pattern}"))
            {
                arm.guard = Some((Default::default(), parse_quote!(!#on)));
            }
        }
    }

    fn visit_expr_mut(&mut self, e: &mut Expr) {
        if matches!(e, Expr::Const(_)) {
            return;
        }
        visit_mut::visit_expr_mut(self, e);
        let new = match e {
            Expr::Binary(b) => self.binary(b),
            Expr::Unary(u) => self.unary(u),
            _ => None,
        };
        if let Some(new) = new {
            *e = new;
        }
    }
}

/// What an operator may be taken for.
fn others(op: &BinOp) -> Vec<BinOp> {
    match op {
        BinOp::Eq(_) => vec![parse_quote!(!=)],
        BinOp::Ne(_) => vec![parse_quote!(==)],
        BinOp::Lt(_) => vec![parse_quote!(<=), parse_quote!(>)],
        BinOp::Gt(_) => vec![parse_quote!(>=), parse_quote!(<)],
        BinOp::Le(_) => vec![parse_quote!(<), parse_quote!(>)],
        BinOp::Ge(_) => vec![parse_quote!(>), parse_quote!(<)],
        BinOp::Add(_) => vec![parse_quote!(-), parse_quote!(*)],
        BinOp::Sub(_) => vec![parse_quote!(+), parse_quote!(/)],
        BinOp::Mul(_) => vec![parse_quote!(+), parse_quote!(/)],
        BinOp::Div(_) => vec![parse_quote!(*), parse_quote!(%)],
        BinOp::Rem(_) => vec![parse_quote!(/), parse_quote!(+)],
        BinOp::AddAssign(_) => vec![parse_quote!(-=), parse_quote!(*=)],
        BinOp::SubAssign(_) => vec![parse_quote!(+=), parse_quote!(/=)],
        BinOp::MulAssign(_) => vec![parse_quote!(+=), parse_quote!(/=)],
        BinOp::DivAssign(_) => vec![parse_quote!(*=), parse_quote!(%=)],
        BinOp::BitAnd(_) => vec![parse_quote!(|)],
        BinOp::BitOr(_) => vec![parse_quote!(&)],
        BinOp::Shl(_) => vec![parse_quote!(>>)],
        BinOp::Shr(_) => vec![parse_quote!(<<)],
        BinOp::BitXorAssign(_) => vec![parse_quote!(|=)],
        BinOp::BitOrAssign(_) => vec![parse_quote!(&=)],
        BinOp::BitAndAssign(_) => vec![parse_quote!(|=)],
        _ => Vec::new(),
    }
}

fn holds_let(e: &Expr) -> bool {
    match e {
        Expr::Let(_) => true,
        Expr::Binary(b) => holds_let(&b.left) || holds_let(&b.right),
        Expr::Paren(p) => holds_let(&p.expr),
        _ => false,
    }
}

/// What a function of this type may return at once; nothing where there is no telling.
fn values_of(output: &ReturnType) -> Vec<Expr> {
    match output {
        ReturnType::Default => vec![parse_quote!(())],
        ReturnType::Type(_, t) => values(t),
    }
}

fn values(t: &Type) -> Vec<Expr> {
    let text = t.to_token_stream().to_string().replace(' ', "");
    match text.as_str() {
        "bool" => return vec![parse_quote!(true), parse_quote!(false)],
        "f64" => return vec![parse_quote!(0.0), parse_quote!(1.0), parse_quote!(-1.0)],
        "usize" | "u8" | "u16" | "u32" | "u64" | "u128" | "i32" | "i64" | "i8" | "isize" => {
            return vec![parse_quote!(0), parse_quote!(1)];
        }
        "String" => {
            return vec![
                parse_quote!(String::new()),
                parse_quote!("xyzzy".to_string()),
            ];
        }
        "&str" | "&'staticstr" => return vec![parse_quote!(""), parse_quote!("xyzzy")],
        "()" => return vec![parse_quote!(())],
        _ => {}
    }
    let Type::Path(p) = t else { return Vec::new() };
    let Some(last) = p.path.segments.last() else {
        return Vec::new();
    };
    let inner = || match &last.arguments {
        syn::PathArguments::AngleBracketed(a) => a.args.iter().find_map(|a| match a {
            syn::GenericArgument::Type(t) => Some(values(t)),
            _ => None,
        }),
        _ => None,
    };
    match last.ident.to_string().as_str() {
        "Option" => {
            let some = inner().unwrap_or_default().into_iter();
            let some = some.map(|v| parse_quote!(Some(#v)));
            std::iter::once(parse_quote!(None)).chain(some).collect()
        }
        "Result" => {
            let ok = inner().unwrap_or_default().into_iter();
            ok.map(|v| parse_quote!(Ok(#v))).collect()
        }
        "Vec" => vec![parse_quote!(Vec::new())],
        "BTreeMap" | "BTreeSet" | "HashMap" => vec![parse_quote!(Default::default())],
        _ => Vec::new(),
    }
}
