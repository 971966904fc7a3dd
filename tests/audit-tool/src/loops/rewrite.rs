//! Where a counter goes into a loop, as text to be written at a place of the source.

use syn::spanned::Spanned;

use crate::copied_tree;
use crate::loops::{chain_root, shown};

/// The module of the counters.
pub const MODULE: &str = "loop_counts";
/// Stands in the text of an edit for the number of the loop.
pub const SITE: &str = "\u{1}site\u{1}";
/// Stands around the text that computes the bound, which is left out where it does not compile.
pub const BOUND: &str = "\u{1}bound\u{1}";

/// Text to be written into a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// Byte before which it goes.
    pub at: usize,
    /// The text.
    pub text: String,
}

impl Edit {
    fn before(syntax: &impl Spanned, text: String) -> Self {
        Self { at: syntax.span().byte_range().start, text }
    }

    fn behind(syntax: &impl Spanned, text: impl Into<String>) -> Self {
        Self { at: syntax.span().byte_range().end, text: text.into() }
    }
}

/// Methods that make an iterator of a container.
const MAKERS: &[&str] = &[
    "iter",
    "iter_mut",
    "into_iter",
    "chunks",
    "chunks_exact",
    "chunks_mut",
    "chunks_exact_mut",
    "rchunks",
    "windows",
    "drain",
    "bytes",
    "split",
];

/// Methods of slices and vectors that walk all of them and do not change the container before.
const WALKERS: &[&str] = &["contains", "starts_with", "ends_with", "binary_search_by", "partition_point"];

/// The same, of containers that may be changed.
const CHANGERS: &[&str] = &[
    "fill",
    "fill_with",
    "clear",
    "retain",
    "truncate",
    "reverse",
    "rotate_left",
    "rotate_right",
    "copy_from_slice",
    "clone_from_slice",
];

/// Counts the turns of a `for`.
pub fn of_for_loop(each: &syn::ExprForLoop, bound: &str) -> Vec<Edit> {
    // A chain of several containers turns for each of them, one of iterators within iterators for each of those.
    let several = [".chain(", "flat_map(", "flatten("].iter().any(|word| shown(&each.expr).contains(word));
    let bound = value_of(bound).or_else(|| capacity_of(chain_root(&each.expr)).filter(|_| !several));
    let open = format!(
        "{{ let mut counted_turns = {}::Turns::new({SITE}, {}); ",
        copied_tree::path_of(MODULE),
        marked(bound)
    );
    let inside = Edit::behind(&each.body.brace_token.span.open(), " counted_turns.turn();");
    vec![Edit::before(each, open), inside, Edit::behind(each, " }")]
}

/// Counts what a chain of iterators takes from its source, or how long the container is that a method walks.
/// Nothing where neither can be seen.
pub fn of_chain(call: &syn::ExprMethodCall, adapters: &[&str], bound: &str) -> Vec<Edit> {
    let calls = calls_from_the_root(call);
    let named =
        |call: &syn::ExprMethodCall, names: &[&str]| names.contains(&call.method.to_string().as_str());
    let method = call.method.to_string();
    let root = chain_root(&syn::Expr::MethodCall(call.clone())).clone();
    let bound = marked(value_of(bound).or_else(|| capacity_of(&root)));
    let counted = format!(".loop_counted({SITE}, {bound})");
    if matches!(root, syn::Expr::Range(_)) {
        let first = calls.first().map(|first| Edit::behind(&first.receiver, counted));
        return first.into_iter().collect();
    }
    if let Some(maker) = calls.iter().find(|call| named(call, MAKERS)) {
        return vec![Edit::behind(*maker, counted)];
    }
    if let Some(adapter) = calls.iter().find(|call| named(call, adapters)) {
        return vec![Edit::behind(&adapter.receiver, counted)];
    }
    match method.as_str() {
        "extend_from_slice" => {
            let text = format!(".loop_walked({SITE})");
            call.args.first().map(|argument| Edit::behind(argument, text)).into_iter().collect()
        }
        "extend" => call.args.first().map(|argument| Edit::behind(argument, counted)).into_iter().collect(),
        "last" => vec![],
        _ if named(call, WALKERS) => {
            vec![Edit::behind(&call.receiver, format!(".loop_walked({SITE})"))]
        }
        _ if named(call, CHANGERS) => {
            vec![Edit::behind(&call.receiver, format!(".loop_walked_mut({SITE})"))]
        }
        _ => vec![Edit::behind(&call.receiver, counted)],
    }
}

/// The calls of a chain, the innermost first.
fn calls_from_the_root(call: &syn::ExprMethodCall) -> Vec<&syn::ExprMethodCall> {
    let mut calls = vec![call];
    let mut receiver = &*call.receiver;
    loop {
        receiver = match receiver {
            syn::Expr::MethodCall(inner) => {
                calls.push(inner);
                &inner.receiver
            }
            syn::Expr::Paren(inner) => &inner.expr,
            _ => break,
        };
    }
    calls.reverse();
    calls
}

/// The bound as an expression of 64 bits, where its text is a literal, a constant, or arithmetic with those.
fn value_of(bound: &str) -> Option<String> {
    let value = bound.split(" (from ").next().unwrap_or(bound);
    wide(&syn::parse_str::<syn::Expr>(value).ok()?)
}

/// Each number is widened before it is reckoned with: `u16::MAX + 1` is one more than fits.
fn wide(expression: &syn::Expr) -> Option<String> {
    match expression {
        syn::Expr::Lit(_) => Some(format!("({} as u64)", shown(expression))),
        syn::Expr::Path(path) => {
            let name = path.path.segments.last()?.ident.to_string();
            (!name.chars().any(char::is_lowercase)).then(|| format!("({} as u64)", shown(expression)))
        }
        syn::Expr::Binary(binary) => {
            Some(format!("({} {} {})", wide(&binary.left)?, shown(&binary.op), wide(&binary.right)?))
        }
        syn::Expr::Paren(inner) => wide(&inner.expr),
        _ => None,
    }
}

/// The capacity of a container that can be named twice without harm.
fn capacity_of(expression: &syn::Expr) -> Option<String> {
    fn is_place(expression: &syn::Expr) -> bool {
        match expression {
            syn::Expr::Path(_) => true,
            syn::Expr::Field(field) => is_place(&field.base),
            _ => false,
        }
    }
    is_place(expression)
        .then(|| format!("{}::Capacity(&{}).of()", copied_tree::path_of(MODULE), shown(expression)))
}

fn marked(bound: Option<String>) -> String {
    bound.map_or_else(|| String::from("0"), |bound| format!("{BOUND}{bound}{BOUND}"))
}

#[cfg(test)]
mod tests {
    use super::value_of;

    #[test]
    fn bounds_become_numbers_of_64_bits() {
        assert_eq!(value_of("u16::MAX + 1").as_deref(), Some("((u16::MAX as u64) + (1 as u64))"));
        assert_eq!(value_of("HALF (from HALF / 2)").as_deref(), Some("(HALF as u64)"));
        assert_eq!((value_of("capacity of `x`"), value_of("count")), (None, None));
    }
}
