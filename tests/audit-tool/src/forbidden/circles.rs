//! Functions that call one another in a circle: found in the sources, where a line can be named.
//!
//! Known are calls of a free function of the same file, of a method of `self`, and of `Type::function` within one crate of the core, or one module of the drivers.
//! What else can close a circle (a trait, a closure that is handed on) only the call graph of the compiled image shows.

use std::collections::{BTreeMap, BTreeSet};

use syn::spanned::Spanned as _;
use syn::visit::{self, Visit};

use crate::claim::Finding;
use crate::sources::{SourceFile, is_test_only, macros};

/// Who calls whom, with the place of the first such call.
type Calls = BTreeMap<String, BTreeMap<String, (String, usize)>>;

/// Circles of two functions and more, each at the call that closes it.
pub fn inspect(files: &[SourceFile]) -> Vec<Finding> {
    let mut calls = Calls::new();
    for file in files {
        let mut visitor = Visitor { file, calls: &mut calls, inside: None, owner: None };
        visitor.visit_file(&file.syntax);
    }
    let known: BTreeSet<String> = calls.keys().cloned().collect();
    let graph = calls
        .iter()
        .map(|(caller, callees)| {
            (caller.clone(), callees.keys().filter(|callee| known.contains(*callee)).cloned().collect())
        })
        .collect();
    let circles = cycles(&graph).into_iter().filter(|circle| circle.len() > 1);
    circles.filter_map(|circle| finding(&calls, &circle)).collect()
}

fn finding(calls: &Calls, circle: &[String]) -> Option<Finding> {
    let (place, line) = calls.get(circle.last()?)?.get(circle.first()?)?.clone();
    let short = |name: &String| name.rsplit('/').next().unwrap_or(name).to_owned();
    let shown = circle.iter().map(short).collect::<Vec<_>>().join(" → ");
    Some(Finding {
        place,
        line,
        message: format!("{shown} call one another in a circle; write a bounded loop"),
    })
}

struct Visitor<'a> {
    file: &'a SourceFile,
    calls: &'a mut Calls,
    inside: Option<String>,
    owner: Option<String>,
}

impl Visitor<'_> {
    fn free(&self, name: &str) -> String {
        format!("{}/{name}", self.file.path)
    }

    fn method(&self, owner: &str, name: &str) -> String {
        let scope = self.file.path.split('/').take(3).collect::<Vec<_>>().join("/");
        format!("{scope}/{owner}::{name}")
    }

    fn within(&mut self, name: String, visit: impl FnOnce(&mut Self)) {
        self.calls.entry(name.clone()).or_default();
        let outer = self.inside.replace(name);
        visit(self);
        self.inside = outer;
    }

    fn called(&mut self, callee: String, line: usize) {
        let Some(caller) = self.inside.clone() else { return };
        let place = (self.file.path.clone(), line);
        self.calls.entry(caller).or_default().entry(callee).or_insert(place);
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if !is_test_only(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        if !is_test_only(&function.attrs) {
            let name = self.free(&function.sig.ident.to_string());
            self.within(name, |inner| visit::visit_item_fn(inner, function));
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if let (Some(owner), false) = (self.owner.clone(), is_test_only(&function.attrs)) {
            let name = self.method(&owner, &function.sig.ident.to_string());
            self.within(name, |inner| visit::visit_impl_item_fn(inner, function));
        }
    }

    /// Only the methods of the type itself: those of a trait share their names with others.
    fn visit_item_impl(&mut self, block: &'ast syn::ItemImpl) {
        let owner = match &*block.self_ty {
            syn::Type::Path(path) if block.trait_.is_none() => {
                path.path.segments.last().map(|part| part.ident.to_string())
            }
            _ => None,
        };
        let outer = std::mem::replace(&mut self.owner, owner);
        visit::visit_item_impl(self, block);
        self.owner = outer;
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let on_itself = matches!(&*call.receiver, syn::Expr::Path(path) if path.path.is_ident("self"));
        if let (true, Some(owner)) = (on_itself, self.owner.clone()) {
            let callee = self.method(&owner, &call.method.to_string());
            self.called(callee, call.method.span().start().line);
        }
        visit::visit_expr_method_call(self, call);
    }

    /// Handing a function on is as good as calling it.
    fn visit_expr_path(&mut self, path: &'ast syn::ExprPath) {
        let segments: Vec<String> = path.path.segments.iter().map(|part| part.ident.to_string()).collect();
        let line = path.span().start().line;
        match segments.as_slice() {
            [name] => self.called(self.free(name), line),
            [.., owner, name] => {
                let owner = self.owner.clone().filter(|_| owner == "Self").unwrap_or_else(|| owner.clone());
                self.called(self.method(&owner, name), line);
            }
            [] => {}
        }
        visit::visit_expr_path(self, path);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        let arguments = macros::arguments(invocation).unwrap_or_default();
        arguments.iter().for_each(|argument| Visit::visit_expr(self, argument));
    }
}

/// Cycles in a call graph: each function that can reach itself, with the cycle.
pub fn cycles(calls: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut done = BTreeSet::new();
    for start in calls.keys() {
        let mut path = vec![(start.clone(), calls[start].iter().cloned().collect::<Vec<_>>())];
        while let Some((_, pending)) = path.last_mut() {
            let Some(next) = pending.pop() else {
                if let Some((name, _)) = path.pop() {
                    done.insert(name);
                }
                continue;
            };
            if let Some(position) = path.iter().position(|(name, _)| *name == next) {
                found.push(path.iter().skip(position).map(|(name, _)| name.clone()).collect());
            } else if !done.contains(&next) {
                let callees = calls.get(&next).map(|set| set.iter().cloned().collect()).unwrap_or_default();
                path.push((next, callees));
            }
        }
    }
    found
}
