//! Small questions about the syntax around a loop.

use syn::visit::Visit;

/// The chain names something that only iterators have: `map` and `filter` alone may belong to an `Option`.
pub fn is_iterator(chain: &str) -> bool {
    let sources = [
        ".iter()",
        ".iter_mut()",
        ".into_iter()",
        ".enumerate()",
        ".step_by(",
        ".chunks",
        ".windows(",
        ".flatten()",
        "..",
    ];
    sources.iter().any(|source| chain.contains(source))
}

pub fn is_range_type(kind: &syn::Type) -> bool {
    let syn::Type::Path(path) = kind else { return false };
    path.path.segments.last().is_some_and(|last| last.ident.to_string().starts_with("Range"))
}

pub fn name_of(pattern: &syn::Pat) -> Option<String> {
    match pattern {
        syn::Pat::Ident(name) => Some(name.ident.to_string()),
        syn::Pat::Type(typed) => name_of(&typed.pat),
        _ => None,
    }
}

/// Every turn of the block passes an `.await`: one that a branch, a closure or an inner loop may skip does not count.
pub fn awaits(block: &syn::Block) -> bool {
    struct Finder(bool);
    impl<'ast> Visit<'ast> for Finder {
        fn visit_expr_await(&mut self, _: &'ast syn::ExprAwait) {
            self.0 = true;
        }
        fn visit_expr_if(&mut self, branch: &'ast syn::ExprIf) {
            self.visit_expr(&branch.cond);
        }
        fn visit_expr_match(&mut self, choice: &'ast syn::ExprMatch) {
            self.visit_expr(&choice.expr);
        }
        fn visit_expr_closure(&mut self, _: &'ast syn::ExprClosure) {}
        fn visit_expr_async(&mut self, _: &'ast syn::ExprAsync) {}
        fn visit_expr_for_loop(&mut self, _: &'ast syn::ExprForLoop) {}
        fn visit_expr_while(&mut self, _: &'ast syn::ExprWhile) {}
        fn visit_expr_loop(&mut self, _: &'ast syn::ExprLoop) {}
        fn visit_item(&mut self, _: &'ast syn::Item) {}
    }
    let mut finder = Finder(false);
    finder.visit_block(block);
    finder.0
}

pub fn without_parentheses(expression: &syn::Expr) -> &syn::Expr {
    match expression {
        syn::Expr::Paren(inner) => &inner.expr,
        other => other,
    }
}
