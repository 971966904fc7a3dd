//! How often an expression that is walked can turn, or why that may never end.
//!
//! A chain of iterators is bounded by the container or the range at its root, and by `take(CONSTANT)` anywhere in it.

use crate::loops::bounds::{Bound, Names, shorten, shown};
use crate::loops::words::ENDLESS;

impl Names {
    /// The bound of what a `for` walks.
    pub fn bound_of(&self, expression: &syn::Expr) -> Result<Bound, String> {
        match expression {
            syn::Expr::Range(range) => self.range_bound(range),
            syn::Expr::Paren(inner) => self.bound_of(&inner.expr),
            syn::Expr::Reference(inner) => Ok(container(&inner.expr)),
            _ => self.chain_bound(expression),
        }
    }

    /// The bound of an iterator chain, found at its root.
    pub fn chain_bound(&self, expression: &syn::Expr) -> Result<Bound, String> {
        if let Some(problem) = self.never_ends(expression) {
            return Err(problem);
        }
        let text = shown(expression);
        let taken = self.taken(expression);
        let limited = text.contains(".zip(") || taken.is_some();
        if let Some(bound) = taken {
            return Ok(bound);
        }
        let outer = match chain_root(expression) {
            syn::Expr::Range(range) => match self.range_bound(range) {
                Err(_) if limited => {
                    Ok(Bound { text: shorten(&text), how: "zipped with a container of fixed capacity" })
                }
                bound => bound,
            },
            root => Ok(chained(expression, container(root))),
        };
        outer.map(|outer| self.flattened(expression, outer))
    }

    /// What `flat_map` makes of each turn turns for all of them.
    fn flattened(&self, expression: &syn::Expr, outer: Bound) -> Bound {
        let (mut current, mut text) = (expression, outer.text);
        while let syn::Expr::MethodCall(call) = current {
            if call.method == "flat_map"
                && let Some(syn::Expr::Closure(closure)) = call.args.first()
            {
                let inner = self.bound_of(without_block(&closure.body)).map(|bound| bound.text);
                let inner = inner.unwrap_or_else(|_| String::from("turns of the closure"));
                text = format!("({text}) * ({inner})");
            }
            current = &call.receiver;
        }
        Bound { text, ..outer }
    }

    /// Why walking the expression may go on for ever; `None`: it comes to an end.
    pub fn never_ends(&self, expression: &syn::Expr) -> Option<String> {
        match expression {
            syn::Expr::Range(range) => self.range_bound(range).err(),
            syn::Expr::Paren(inner) => self.never_ends(&inner.expr),
            syn::Expr::Group(inner) => self.never_ends(&inner.expr),
            syn::Expr::Reference(inner) => self.never_ends(&inner.expr),
            syn::Expr::Path(path) => path.path.get_ident().and_then(|name| self.endless(&name.to_string())),
            syn::Expr::Call(call) => self.call_never_ends(call),
            syn::Expr::MethodCall(call) => {
                let receiver = self.never_ends(&call.receiver);
                let argument = || call.args.first().and_then(|argument| self.never_ends(argument));
                match call.method.to_string().as_str() {
                    "take" if call.args.first().is_some_and(|n| self.largest(n).is_some()) => None,
                    "zip" => receiver.filter(|_| argument().is_some()),
                    "chain" => receiver.or_else(argument),
                    "cycle" => Some(endless("cycle")),
                    _ => receiver,
                }
            }
            _ => None,
        }
    }

    pub fn call_never_ends(&self, call: &syn::ExprCall) -> Option<String> {
        let (source, owner) = called(call)?;
        let argument = |number: usize| call.args.iter().nth(number);
        match source.as_str() {
            "zip" => argument(0)
                .and_then(|a| self.never_ends(a))
                .filter(|_| argument(1).is_some_and(|b| self.never_ends(b).is_some())),
            "repeat_n" => {
                let times = argument(1).and_then(|times| self.largest(times));
                times.is_none().then(|| {
                    String::from("the number of repetitions is not a constant; write `.min(CONSTANT)`")
                })
            }
            // An array has a length.
            "from_fn" if owner.as_deref() == Some("array") => None,
            name => ENDLESS.contains(&name).then(|| endless(name)),
        }
    }

    /// `take(BOUND)` anywhere in the chain.
    pub fn taken(&self, expression: &syn::Expr) -> Option<Bound> {
        let mut current = expression;
        // Bounded by the nesting of the parsed expression.
        loop {
            current = match current {
                syn::Expr::MethodCall(call) => {
                    let bound = call.args.first().filter(|_| call.method == "take");
                    if let Some(bound) = bound.and_then(|argument| self.largest(argument)) {
                        return Some(bound);
                    }
                    &call.receiver
                }
                syn::Expr::Paren(inner) => &inner.expr,
                syn::Expr::Reference(inner) => &inner.expr,
                _ => return None,
            };
        }
    }

    pub fn range_bound(&self, range: &syn::ExprRange) -> Result<Bound, String> {
        let Some(end) = &range.end else {
            return Err(String::from(
                "an open range never ends; give it a constant end or `.take(CONSTANT)`",
            ));
        };
        let bound = self.largest(end).ok_or_else(|| {
            format!("the range ends at `{}`, which is not a constant; write `.min(CONSTANT)`", shown(end))
        })?;
        // From below zero, and through the last number itself, there are more turns than the end says.
        let below = match range.start.as_deref() {
            Some(syn::Expr::Unary(start)) if matches!(start.op, syn::UnOp::Neg(_)) => {
                format!(" + {}", shown(&start.expr))
            }
            _ => String::new(),
        };
        let last = if matches!(range.limits, syn::RangeLimits::Closed(_)) { " + 1" } else { "" };
        Ok(Bound { text: format!("{}{below}{last}", bound.text), ..bound })
    }
}

fn endless(source: &str) -> String {
    format!("`{source}` never ends; add `.take(CONSTANT)`")
}

/// Name of the called function, and what stands before it.
fn called(call: &syn::ExprCall) -> Option<(String, Option<String>)> {
    let syn::Expr::Path(path) = &*call.func else { return None };
    let mut segments = path.path.segments.iter().rev().map(|segment| segment.ident.to_string());
    Some((segments.next()?, segments.next()))
}

/// The receiver at the start of a chain of method calls.
pub fn chain_root(expression: &syn::Expr) -> &syn::Expr {
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

/// What is chained behind the first container turns too.
fn chained(expression: &syn::Expr, first: Bound) -> Bound {
    let mut current = expression;
    let mut text = String::new();
    while let syn::Expr::MethodCall(call) = current {
        if let Some(argument) = call.args.first().filter(|_| call.method == "chain") {
            text.insert_str(0, &format!(" + that of `{}`", shorten(&shown(chain_root(argument)))));
        }
        current = &call.receiver;
    }
    Bound { text: first.text + &text, ..first }
}

/// The last expression of a block.
fn without_block(body: &syn::Expr) -> &syn::Expr {
    match body {
        syn::Expr::Block(block) => match block.block.stmts.last() {
            Some(syn::Stmt::Expr(last, None)) => last,
            _ => body,
        },
        other => other,
    }
}

fn container(expression: &syn::Expr) -> Bound {
    Bound {
        text: format!("capacity of `{}`", shorten(&shown(expression))),
        how: "slice, array or container of fixed capacity",
    }
}

#[cfg(test)]
mod tests {
    use crate::loops::list as loops_of;
    use crate::sources;

    #[test]
    fn walks_within_walks_turn_for_each_of_them() {
        let bound = |text: &str| {
            let file = sources::parse("core-nostd/guard/src/example.rs", text.to_owned()).expect("it parses");
            loops_of(&file).0.first().map(|site| site.bound.clone())
        };
        let within = "fn f() { for x in (0..N).flat_map(|y| (0..=M).map(move |x| (x, y))) {} }";
        assert_eq!(bound(within).as_deref(), Some("(N) * (M + 1)"));
        let within = "fn f() { for x in (0..N).flat_map(|y| { g(y); a.iter() }) {} }";
        assert_eq!(bound(within).as_deref(), Some("(N) * (capacity of `a`)"));
    }
}
