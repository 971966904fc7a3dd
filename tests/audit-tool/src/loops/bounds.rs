//! Upper bounds of expressions, as far as their text proves them.
//!
//! A bound is a literal, a constant, the capacity of a container, the largest value of a small type, or arithmetic that
//! cannot exceed those. Names are followed to their `let` in the same function; a name that is bound otherwise, or
//! that may change, proves nothing.

use std::collections::BTreeMap;

use quote::ToTokens;

/// What is known of the names in scope, innermost scope last. `None`: bound, but to nothing that is known.
#[derive(Default)]
pub struct Names {
    scopes: Vec<BTreeMap<String, Option<Bound>>>,
    /// Names that may be walked for ever, and why, by scope; `None`: bound anew to something that ends.
    endless: Vec<BTreeMap<String, Option<String>>>,
}

/// An upper bound and how it is known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bound {
    /// The bound as a reader would say it.
    pub text: String,
    /// How it is known.
    pub how: &'static str,
}

impl Bound {
    fn new(text: impl Into<String>, how: &'static str) -> Self {
        Self { text: text.into(), how }
    }
}

impl Names {
    /// Opens a scope.
    pub fn enter(&mut self) {
        self.scopes.push(BTreeMap::new());
        self.endless.push(BTreeMap::new());
    }

    /// Closes the innermost scope.
    pub fn leave(&mut self) {
        self.scopes.pop();
        self.endless.pop();
    }

    /// A name is bound in the innermost scope.
    pub fn bind(&mut self, name: String, bound: Option<Bound>) {
        if let Some(scope) = self.endless.last_mut() {
            scope.insert(name.clone(), None);
        }
        if let Some(scope) = self.scopes.last_mut() {
            scope.insert(name, bound);
        }
    }

    /// Walking what the name holds may never end.
    pub fn unbounded(&mut self, name: String, why: &str) {
        if let Some(scope) = self.endless.last_mut() {
            scope.insert(name, Some(why.to_owned()));
        }
    }

    /// Why walking what the name holds may never end.
    pub fn endless(&self, name: &str) -> Option<String> {
        self.endless.iter().rev().find_map(|scope| scope.get(name)).cloned().flatten()
    }

    /// What the name is bound to; the outer `None`: nothing in sight binds it.
    fn bound(&self, name: &str) -> Option<Option<Bound>> {
        self.scopes.iter().rev().find_map(|scope| scope.get(name)).cloned()
    }

    /// The largest value that an expression can have, if that can be seen.
    pub fn largest(&self, expression: &syn::Expr) -> Option<Bound> {
        match expression {
            syn::Expr::Lit(_) => Some(Bound::new(shown(expression), "a literal")),
            syn::Expr::Path(path) => self.of_path(&path.path),
            syn::Expr::Paren(inner) => self.largest(&inner.expr),
            syn::Expr::Group(inner) => self.largest(&inner.expr),
            syn::Expr::Reference(inner) => self.largest(&inner.expr),
            syn::Expr::Unary(unary) if matches!(unary.op, syn::UnOp::Deref(_)) => self.largest(&unary.expr),
            syn::Expr::Cast(cast) => self.largest(&cast.expr),
            syn::Expr::Binary(binary) => self.of_arithmetic(binary),
            syn::Expr::MethodCall(call) => self.of_method(call),
            syn::Expr::Call(call) => self.of_conversion(call),
            _ => None,
        }
    }

    fn of_path(&self, path: &syn::Path) -> Option<Bound> {
        let name = path.segments.last()?.ident.to_string();
        if path.segments.len() == 1
            && let Some(bound) = self.bound(&name)
        {
            return bound;
        }
        let of_type = path.segments.len() > 1
            && path.segments.first().is_some_and(|first| is_wide_number(&first.ident.to_string()));
        let constant = is_constant_name(&name) && !(of_type && (name == "MAX" || name == "BITS"));
        constant.then(|| Bound::new(shown(path), "a constant"))
    }

    fn of_arithmetic(&self, binary: &syn::ExprBinary) -> Option<Bound> {
        let (left, right) = (self.largest(&binary.left), self.largest(&binary.right));
        let (both, one) = match binary.op {
            syn::BinOp::Add(_) | syn::BinOp::Mul(_) => (left.zip(right), None),
            // A difference of unsigned numbers that are not constants may wrap to the largest number.
            syn::BinOp::Sub(_) => (left.zip(right).filter(|(a, b)| a.is_fixed() && b.is_fixed()), None),
            syn::BinOp::Div(_) | syn::BinOp::Shr(_) => (None, left),
            syn::BinOp::Rem(_) => (None, right.or(left)),
            syn::BinOp::BitAnd(_) => (None, left.or(right)),
            _ => (None, None),
        };
        let both = both.map(|(a, _)| Bound { text: shown(binary), how: a.how });
        both.or_else(|| {
            one.map(|bound| Bound { text: format!("{} (from {})", bound.text, shown(binary)), ..bound })
        })
    }

    fn of_method(&self, call: &syn::ExprMethodCall) -> Option<Bound> {
        let argument = || call.args.first().and_then(|argument| self.largest(argument));
        let capped = |bound: Bound| Bound::new(bound.text, "capped by a constant");
        match call.method.to_string().as_str() {
            "min" => argument().or_else(|| self.largest(&call.receiver)).map(capped),
            "clamp" => call.args.last().and_then(|argument| self.largest(argument)).map(capped),
            "max" | "saturating_add" | "saturating_mul" => {
                let (left, right) = (self.largest(&call.receiver)?, argument()?);
                Some(Bound { text: format!("{}, {}", left.text, right.text), ..left })
            }
            "saturating_sub" | "div_ceil" => self.largest(&call.receiver),
            "len" if call.args.is_empty() => Some(Bound::new(
                format!("capacity of `{}`", shorten(&shown(&call.receiver))),
                "slice, array or container of fixed capacity",
            )),
            _ => None,
        }
    }

    /// `usize::from(x)` and its like keep the value; `min(a, b)` keeps the lesser.
    fn of_conversion(&self, call: &syn::ExprCall) -> Option<Bound> {
        let function = shown(&call.func);
        let mut arguments = call.args.iter().map(|argument| self.largest(argument));
        match function.as_str() {
            "usize::from" | "u64::from" | "u32::from" | "u16::from" | "i32::from" | "i64::from" => {
                arguments.next()?
            }
            "min" | "core::cmp::min" | "cmp::min" => arguments.flatten().next(),
            _ => None,
        }
    }
}

impl Bound {
    /// Does not depend on a value at run time.
    fn is_fixed(&self) -> bool {
        matches!(self.how, "a literal" | "a constant")
    }
}

/// The largest value of a small unsigned type, for parameters.
pub fn of_type(kind: &syn::Type) -> Option<Bound> {
    match shown(kind).as_str() {
        "u8" => Some(Bound::new("255", "largest value of its type")),
        "u16" => Some(Bound::new("65535", "largest value of its type")),
        _ => None,
    }
}

fn is_wide_number(name: &str) -> bool {
    matches!(name, "usize" | "u32" | "u64" | "u128" | "isize" | "i32" | "i64" | "i128")
}

fn is_constant_name(name: &str) -> bool {
    name.chars().any(char::is_alphabetic)
        && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
}

/// Source text without spaces that syntax does not need.
pub fn shown(syntax: &impl ToTokens) -> String {
    let text = syntax.to_token_stream().to_string();
    [" . ", " :: ", " (", "( ", " )", " ,", " [", "[ ", " ]", "& ", " ..", ".. ", " - ", " + ", " < ", " >"]
        .iter()
        .fold(text, |text, spaced| text.replace(spaced, spaced.trim()))
}

/// The beginning of a long text.
pub fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
