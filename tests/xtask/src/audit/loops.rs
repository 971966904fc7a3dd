//! Every loop and every iterator chain of the audited layers, with its bound.
//!
//! `no_std` without an allocator leaves only slices, arrays and containers of fixed capacity, so walking one of them is
//! bounded by its capacity. Ranges must end in a constant. `while` and `loop` have no bound that a reader can see and
//! are refused, except in an `async fn` whose every turn waits for the world (the drivers' thin adaptors).
//!
//! Limits: the syntax is not typed. That a receiver is a container and not a custom endless iterator is checked by
//! refusing the sources of endless iteration (`repeat`, `cycle`, `from_fn`, `successors`, open ranges) unless the same
//! chain says `take(CONSTANT)` or zips with a container.

use quote::ToTokens;
use serde::Serialize;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use super::claim::Finding;
use super::sources::{SourceFile, is_test_only};

/// One loop or iterator chain.
#[derive(Debug, Clone, Serialize)]
pub struct LoopSite {
    /// File from the workspace root.
    pub file: String,
    /// First line.
    pub line: usize,
    /// Last line.
    pub end_line: usize,
    /// Function that holds it.
    pub function: String,
    /// `for`, `while`, `loop` or the consuming method of a chain.
    pub kind: String,
    /// The bound: a constant, a capacity, a container.
    pub bound: String,
    /// How the bound is known.
    pub how: &'static str,
}

/// Methods that walk their receiver to its end, or may.
const CONSUMERS: &[&str] = &[
    "for_each",
    "fold",
    "sum",
    "product",
    "count",
    "any",
    "all",
    "find",
    "find_map",
    "position",
    "rposition",
    "max_by",
    "min_by",
    "max_by_key",
    "min_by_key",
    "last",
    "collect",
    "extend",
    "try_fold",
    "try_for_each",
    "reduce",
    "partition",
    "eq",
    "ne",
    "lt",
    "cmp",
    "is_sorted",
    "rev",
    "copy_from_slice",
    "clone_from_slice",
    "fill",
    "fill_with",
    "extend_from_slice",
    "contains",
    "starts_with",
    "ends_with",
    "rotate_left",
    "rotate_right",
    "swap_with_slice",
    "retain",
    "truncate",
    "clear",
    "binary_search_by",
    "binary_search_by_key",
    "partition_point",
    "map_while",
    "nth",
];

/// Where endless iteration comes from.
const ENDLESS: &[&str] = &["repeat", "repeat_with", "cycle", "from_fn", "successors"];

/// Lists the loops of one file; what has no bound becomes a finding.
pub fn list(file: &SourceFile) -> (Vec<LoopSite>, Vec<Finding>) {
    let mut visitor =
        Visitor { file, function: String::from("(constant)"), waits: false, sites: vec![], findings: vec![] };
    visitor.visit_file(&file.syntax);
    (visitor.sites, visitor.findings)
}

struct Visitor<'a> {
    file: &'a SourceFile,
    function: String,
    /// Inside an `async fn`.
    waits: bool,
    sites: Vec<LoopSite>,
    findings: Vec<Finding>,
}

impl Visitor<'_> {
    fn record(&mut self, at: &dyn Spanned2, kind: &str, bound: Result<(String, &'static str), String>) {
        let (line, end_line) = at.lines();
        match bound {
            Ok((bound, how)) => self.sites.push(LoopSite {
                file: self.file.path.clone(),
                line,
                end_line,
                function: self.function.clone(),
                kind: kind.to_owned(),
                bound,
                how,
            }),
            Err(message) => {
                self.findings.push(Finding { place: self.file.path.clone(), line, message });
            }
        }
    }

    fn within(&mut self, name: String, waits: bool, inside: impl FnOnce(&mut Self)) {
        let outer = (std::mem::replace(&mut self.function, name), std::mem::replace(&mut self.waits, waits));
        inside(self);
        (self.function, self.waits) = outer;
    }
}

/// Lines of a piece of syntax.
trait Spanned2 {
    fn lines(&self) -> (usize, usize);
}

impl<T: Spanned> Spanned2 for T {
    fn lines(&self) -> (usize, usize) {
        let span = self.span();
        (span.start().line, span.end().line)
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if !is_test_only(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        if is_test_only(&function.attrs) {
            return;
        }
        let waits = function.sig.asyncness.is_some();
        self.within(function.sig.ident.to_string(), waits, |inner| visit::visit_item_fn(inner, function));
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if is_test_only(&function.attrs) {
            return;
        }
        let waits = function.sig.asyncness.is_some();
        self.within(function.sig.ident.to_string(), waits, |inner| {
            visit::visit_impl_item_fn(inner, function)
        });
    }

    fn visit_expr_for_loop(&mut self, each: &'ast syn::ExprForLoop) {
        let bound = bound_of(&each.expr);
        self.record(each, "for", bound);
        visit::visit_expr_for_loop(self, each);
    }

    fn visit_expr_while(&mut self, each: &'ast syn::ExprWhile) {
        let bound = unbounded("while", self.waits && awaits(&each.body));
        self.record(each, "while", bound);
        visit::visit_expr_while(self, each);
    }

    fn visit_expr_loop(&mut self, each: &'ast syn::ExprLoop) {
        let bound = unbounded("loop", self.waits && awaits(&each.body));
        self.record(each, "loop", bound);
        visit::visit_expr_loop(self, each);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let method = call.method.to_string();
        let no_argument_extremum = (method == "max" || method == "min") && call.args.is_empty();
        if no_argument_extremum || CONSUMERS.contains(&method.as_str()) {
            let bound = chain_bound(&call.receiver);
            self.record(call, &method, bound);
        }
        visit::visit_expr_method_call(self, call);
    }
}

fn unbounded(kind: &str, waits: bool) -> Result<(String, &'static str), String> {
    if waits {
        return Ok((String::from("one turn per event"), "waits for the world in every turn"));
    }
    Err(format!("`{kind}` has no bound that a reader can see; write `for … in 0..CONSTANT`"))
}

/// The block contains `.await`.
fn awaits(block: &syn::Block) -> bool {
    struct Finder(bool);
    impl<'ast> Visit<'ast> for Finder {
        fn visit_expr_await(&mut self, _: &'ast syn::ExprAwait) {
            self.0 = true;
        }
    }
    let mut finder = Finder(false);
    finder.visit_block(block);
    finder.0
}

/// The bound of what a `for` walks.
fn bound_of(expression: &syn::Expr) -> Result<(String, &'static str), String> {
    match expression {
        syn::Expr::Range(range) => range_bound(range),
        syn::Expr::Paren(inner) => bound_of(&inner.expr),
        syn::Expr::Reference(inner) => container(&inner.expr),
        _ => chain_bound(expression),
    }
}

/// The bound of an iterator chain, found at its root.
fn chain_bound(expression: &syn::Expr) -> Result<(String, &'static str), String> {
    let text = shown(expression);
    let limited = text.contains(".zip(") || taken(&text).is_some();
    let endless = ENDLESS.iter().find(|source| text.contains(&format!("{source}(")));
    if let Some(source) = endless.filter(|_| !limited) {
        return Err(format!("`{source}` never ends; add `.take(CONSTANT)`"));
    }
    if let Some(constant) = taken(&text) {
        return Ok((constant, "take of a constant"));
    }
    match root(expression) {
        syn::Expr::Range(range) => match range_bound(range) {
            Err(_) if limited => Ok((text, "zipped with a container of fixed capacity")),
            bound => bound,
        },
        root => container(root),
    }
}

/// `take(CONSTANT)` anywhere in the chain.
fn taken(text: &str) -> Option<String> {
    let after = text.split(".take(").nth(1)?;
    let argument = after.split(')').next()?;
    is_constant(argument).then(|| argument.to_owned())
}

/// The receiver at the start of a chain of method calls.
fn root(expression: &syn::Expr) -> &syn::Expr {
    let mut current = expression;
    // Bounded by the nesting of the parsed expression.
    loop {
        current = match current {
            syn::Expr::MethodCall(call) => &call.receiver,
            syn::Expr::Paren(inner) => &inner.expr,
            syn::Expr::Reference(inner) => &inner.expr,
            syn::Expr::Try(inner) => &inner.expr,
            _ => return current,
        };
    }
}

fn container(expression: &syn::Expr) -> Result<(String, &'static str), String> {
    let text = shown(expression);
    Ok((format!("capacity of `{}`", shorten(&text)), "slice, array or container of fixed capacity"))
}

fn range_bound(range: &syn::ExprRange) -> Result<(String, &'static str), String> {
    let Some(end) = &range.end else {
        return Err(String::from("an open range never ends; give it a constant end or `.take(CONSTANT)`"));
    };
    let text = shown(end);
    if is_constant(&text) {
        return Ok((text, "range to a constant"));
    }
    if let Some(constant) = capped(&text) {
        return Ok((constant, "range end capped by a constant"));
    }
    if text.ends_with(".len()") || text.ends_with(".len()-1") {
        return Ok((
            format!("capacity of `{}`", shorten(&text)),
            "slice, array or container of fixed capacity",
        ));
    }
    Err(format!("the range ends at `{text}`, which is not a constant; write `.min(CONSTANT)`"))
}

/// `….min(CONSTANT)` at the end of an expression.
fn capped(text: &str) -> Option<String> {
    let argument = text.rsplit(".min(").next()?.strip_suffix(')')?;
    (text.contains(".min(") && is_constant(argument)).then(|| argument.to_owned())
}

/// A literal, a constant, a const generic, a conversion or simple arithmetic of those.
fn is_constant(text: &str) -> bool {
    let parts = text.split(['+', '-', '*', '/', '(', ')', ' ']).filter(|part| !part.is_empty());
    let mut any = false;
    for part in parts {
        any = true;
        let name = part.trim_start_matches("&").split("::").last().unwrap_or(part);
        let number = name.chars().next().is_some_and(|first| first.is_ascii_digit());
        let constant = name.chars().any(char::is_alphabetic)
            && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
        let conversion =
            matches!(name, "as" | "usize" | "u16" | "u32" | "i32" | "u8" | "i16" | "u64" | "from");
        if !(number || constant || conversion) {
            return false;
        }
    }
    any
}

/// Source text without spaces that syntax does not need.
fn shown(expression: &syn::Expr) -> String {
    let text = expression.to_token_stream().to_string();
    [" . ", " :: ", " (", "( ", " )", " ,", " [", "[ ", " ]", "& ", " ..", ".. ", " - ", " + ", " < ", " >"]
        .iter()
        .fold(text, |text, spaced| text.replace(spaced, spaced.trim()))
}

fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
