//! Walks through the syntax of a file and asks for the bound of each loop.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use crate::claim::Finding;
use crate::facts::facts;
use crate::loops::bounds::{Bound, Names, shown};
use crate::loops::rewrite;
use crate::loops::rewrite::Edit;
use crate::loops::seen::Seen;
use crate::loops::syntax::{awaits, is_iterator, is_range_type, name_of, without_parentheses};
use crate::loops::words::{ADAPTERS, CONSUMERS, ENDLESS, RANGE_TAKERS};
use crate::loops::{LoopSite, bounds};
use crate::sources::{SourceFile, is_test_only, macros};

/// The loops of a file, and what has no bound.
pub fn walk(file: &SourceFile) -> (Vec<LoopSite>, Vec<Finding>) {
    let mut visitor = Visitor {
        file,
        function: String::from("(constant)"),
        waits: false,
        constant: true,
        chain: None,
        names: Names::default(),
        limited: false,
        sites: vec![],
        findings: vec![],
    };
    visitor.visit_file(&file.syntax);
    (visitor.sites, visitor.findings)
}

struct Visitor<'a> {
    file: &'a SourceFile,
    function: String,
    /// Inside an `async fn`.
    waits: bool,
    /// What the compiler computes cannot count.
    constant: bool,
    /// Text of the whole chain of method calls that is being looked at from its last call inwards.
    chain: Option<String>,
    names: Names,
    /// Inside a chain that comes to its end whatever stands in it.
    limited: bool,
    sites: Vec<LoopSite>,
    findings: Vec<Finding>,
}

impl Visitor<'_> {
    fn record(&mut self, at: &impl Spanned, kind: &str, bound: Result<Bound, String>) {
        self.record_with(at, kind, bound, |_| vec![]);
    }

    fn record_with(
        &mut self,
        at: &impl Spanned,
        kind: &str,
        bound: Result<Bound, String>,
        edits: impl FnOnce(&str) -> Vec<Edit>,
    ) {
        let (line, end_line) = (at.span().start().line, at.span().end().line);
        match bound {
            Ok(bound) => self.sites.push(LoopSite {
                edits: if self.constant { vec![] } else { edits(&bound.text) },
                seen: Seen::default(),
                file: self.file.path.clone(),
                line,
                end_line,
                function: self.function.clone(),
                kind: kind.to_owned(),
                bound: bound.text,
                how: bound.how,
            }),
            Err(message) => {
                self.findings.push(Finding { place: self.file.path.clone(), line, message });
            }
        }
    }

    fn within(&mut self, signature: &syn::Signature, inside: impl FnOnce(&mut Self)) {
        let outer = (self.function.clone(), self.waits, self.constant, self.chain.take());
        self.function = signature.ident.to_string();
        self.waits = signature.asyncness.is_some();
        self.constant = signature.constness.is_some();
        self.names.enter();
        for input in &signature.inputs {
            if let syn::FnArg::Typed(typed) = input
                && let syn::Pat::Ident(name) = &*typed.pat
                && name.mutability.is_none()
            {
                self.names.bind(name.ident.to_string(), bounds::of_type(&typed.ty));
                if is_range_type(&typed.ty) {
                    self.names.unbounded(name.ident.to_string(), "a range that the caller chooses");
                }
            }
        }
        inside(self);
        self.names.leave();
        (self.function, self.waits, self.constant, self.chain) = outer;
    }

    /// Comparing, copying or printing a value with an array in it walks the array: the compiler writes those loops.
    fn derived(&mut self, item: &syn::ItemStruct) {
        let derives = item
            .attrs
            .iter()
            .filter(|attribute| attribute.path().is_ident("derive"))
            .map(shown)
            .collect::<String>();
        let arrays = item.fields.iter().filter_map(|field| match &field.ty {
            syn::Type::Array(array) => Some(shown(&array.len)),
            _ => None,
        });
        for length in arrays.collect::<Vec<_>>() {
            if derives.contains("PartialEq") {
                self.function = format!("{} (derived)", item.ident);
                self.record(item, "comparison", Ok(Bound { text: length, how: "length of an array" }));
            }
        }
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if !is_test_only(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.derived(item);
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        if !is_test_only(&function.attrs) {
            self.within(&function.sig, |inner| visit::visit_item_fn(inner, function));
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !is_test_only(&function.attrs) {
            self.within(&function.sig, |inner| visit::visit_impl_item_fn(inner, function));
        }
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.within(&function.sig, |inner| visit::visit_trait_item_fn(inner, function));
    }

    /// Parameters are bound by `within`.
    fn visit_signature(&mut self, _: &'ast syn::Signature) {}

    fn visit_block(&mut self, block: &'ast syn::Block) {
        self.names.enter();
        visit::visit_block(self, block);
        self.names.leave();
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        self.names.enter();
        visit::visit_arm(self, arm);
        self.names.leave();
    }

    fn visit_expr_closure(&mut self, closure: &'ast syn::ExprClosure) {
        self.names.enter();
        let (chain, limited) = (self.chain.take(), std::mem::replace(&mut self.limited, false));
        closure.inputs.iter().for_each(|input| self.visit_pat(input));
        closure.inputs.iter().for_each(|input| {
            if let syn::Pat::Type(typed) = input
                && let syn::Pat::Ident(name) = &*typed.pat
                && is_range_type(&typed.ty)
            {
                self.names.unbounded(name.ident.to_string(), "a range that the caller chooses");
            }
        });
        self.visit_expr(&closure.body);
        (self.chain, self.limited) = (chain, limited);
        self.names.leave();
    }

    /// An iterator of our own has no container behind it that bounds it.
    fn visit_item_impl(&mut self, block: &'ast syn::ItemImpl) {
        let name = shown(&block.self_ty);
        let of_trait = block.trait_.as_ref().map(|implemented| shown(&implemented.0)).unwrap_or_default();
        if of_trait.rsplit("::").next() == Some("Iterator") {
            let known = facts()
                .own_iterator
                .iter()
                .find(|own| self.file.path == own.file && name.starts_with(&own.name));
            let bound = known.map(|own| Bound { text: own.why.clone(), how: "argued, and fuzzed" });
            let message = "an iterator of our own; argue its end under own_iterator in tests/audit.toml";
            self.function = name;
            self.record(&block.self_ty, "own iterator", bound.ok_or_else(|| message.to_owned()));
        }
        visit::visit_item_impl(self, block);
    }

    /// What is walked is excused by its loop or its chain; anything else would hand an endless walk on.
    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        if !self.limited
            && let Some(problem) = self.names.call_never_ends(call)
        {
            self.record(call, "endless source", Err(problem));
        }
        let limited = std::mem::replace(&mut self.limited, false);
        call.args.iter().for_each(|argument| self.handed_on(argument));
        visit::visit_expr_call(self, call);
        self.limited = limited;
    }

    fn visit_expr_range(&mut self, range: &'ast syn::ExprRange) {
        if let (false, Err(problem)) = (self.limited, self.names.range_bound(range)) {
            self.record(range, "range", Err(problem));
        }
        visit::visit_expr_range(self, range);
    }

    /// `a[1..]` is a slice.
    fn visit_expr_index(&mut self, access: &'ast syn::ExprIndex) {
        self.visit_expr(&access.expr);
        match &*access.index {
            syn::Expr::Range(range) => visit::visit_expr_range(self, range),
            index => self.visit_expr(index),
        }
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        let Some(arguments) = macros::arguments(invocation) else {
            for (word, line) in macros::words(&invocation.tokens) {
                if ["loop", "while", "for"].contains(&word.as_str()) || ENDLESS.contains(&word.as_str()) {
                    let message = format!("`{word}` inside a macro cannot be judged; write a function");
                    self.findings.push(Finding { place: self.file.path.clone(), line, message });
                }
            }
            return;
        };
        arguments.iter().for_each(|argument| Visit::visit_expr(self, argument));
    }

    /// `90_000..` in a pattern is no walk.
    fn visit_pat(&mut self, pattern: &'ast syn::Pat) {
        if !matches!(pattern, syn::Pat::Range(_)) {
            visit::visit_pat(self, pattern);
        }
    }

    /// A pattern shadows what the name meant before.
    fn visit_pat_ident(&mut self, name: &'ast syn::PatIdent) {
        self.names.bind(name.ident.to_string(), None);
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        let value = local.init.as_ref().map(|init| &*init.expr);
        let problem = value.and_then(|value| self.names.never_ends(value));
        if let Some(init) = &local.init {
            let kept = problem.is_some() && name_of(&local.pat).is_some();
            let limited = std::mem::replace(&mut self.limited, kept);
            visit::visit_local_init(self, init);
            self.limited = limited;
        }
        match &local.pat {
            syn::Pat::Ident(name) if name.mutability.is_none() => {
                let bound = value.and_then(|value| self.names.largest(value));
                self.names.bind(name.ident.to_string(), bound);
            }
            pattern => self.visit_pat(pattern),
        }
        // A range or an endless chain that is kept is judged where it is walked.
        if let (Some(name), Some(problem)) = (name_of(&local.pat), problem) {
            self.names.unbounded(name, &problem);
        }
    }

    fn visit_expr_for_loop(&mut self, each: &'ast syn::ExprForLoop) {
        let bound = self.names.bound_of(&each.expr);
        self.record_with(each, "for", bound, |bound| rewrite::of_for_loop(each, bound));
        self.names.enter();
        self.visit_pat(&each.pat);
        let limited = std::mem::replace(&mut self.limited, true);
        self.visit_expr(&each.expr);
        self.limited = false;
        self.visit_block(&each.body);
        self.limited = limited;
        self.names.leave();
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

    /// The compiler fills `[value; N]` in a loop.
    fn visit_expr_repeat(&mut self, array: &'ast syn::ExprRepeat) {
        let how = "length of an array, which the compiler fills";
        self.record(array, "fill", Ok(Bound { text: shown(&array.len), how }));
        visit::visit_expr_repeat(self, array);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let method = call.method.to_string();
        let outermost = self.chain.is_none();
        let chain = self.chain.take().unwrap_or_else(|| shown(call));
        let receiver = without_parentheses(&call.receiver);
        let no_argument_extremum = (method == "max" || method == "min") && call.args.is_empty();
        let asks_a_range = method == "contains" && matches!(receiver, syn::Expr::Range(_));
        if !asks_a_range && (no_argument_extremum || CONSUMERS.contains(&method.as_str())) {
            let bound = self.names.chain_bound(&call.receiver);
            self.record_with(call, &method, bound, |bound| rewrite::of_chain(call, ADAPTERS, bound));
        } else if outermost && ADAPTERS.contains(&method.as_str()) && is_iterator(&chain) {
            let bound = self.names.chain_bound(&syn::Expr::MethodCall(call.clone()));
            if bound.is_ok() || !self.limited {
                self.record_with(call, "iterator", bound, |bound| rewrite::of_chain(call, ADAPTERS, bound));
            }
        } else if !asks_a_range
            && !chain.contains(".zip(")
            && let syn::Expr::Range(range) = receiver
            && range.end.is_none()
            && self.taken_in(&chain).is_none()
        {
            // No caller walks it here, but a walk would never end.
            self.record(call, "range", Err(String::from("an open range never ends; add `.take(CONSTANT)`")));
        }
        // An endless source within a chain that ends is no mistake; one that is handed to a method may be.
        let limited = self.limited
            || asks_a_range
            || outermost && self.names.never_ends(&syn::Expr::MethodCall(call.clone())).is_none();
        let outer = std::mem::replace(&mut self.limited, limited);
        self.chain = Some(chain);
        self.visit_expr(&call.receiver);
        self.chain = None;
        self.limited = limited && (method == "zip" || method == "chain");
        for argument in &call.args {
            match argument {
                syn::Expr::Range(range) if RANGE_TAKERS.contains(&method.as_str()) => {
                    visit::visit_expr_range(self, range);
                }
                other => {
                    if !self.limited && !RANGE_TAKERS.contains(&method.as_str()) {
                        self.handed_on(other);
                    }
                    self.visit_expr(other);
                }
            }
        }
        self.limited = outer;
    }
}

impl Visitor<'_> {
    /// A name that holds an endless walk, given to somebody else who may walk it.
    fn handed_on(&mut self, argument: &syn::Expr) {
        if let syn::Expr::Path(path) = argument
            && let Some(problem) = self.names.never_ends(argument)
        {
            self.record(path, "endless source", Err(problem));
        }
    }

    /// `take(BOUND)` in the text of a chain.
    fn taken_in(&self, chain: &str) -> Option<Bound> {
        syn::parse_str::<syn::Expr>(chain).ok().and_then(|expression| self.names.taken(&expression))
    }
}

fn unbounded(kind: &str, waits: bool) -> Result<Bound, String> {
    if waits {
        return Ok(Bound {
            text: String::from("one turn per event"),
            how: "waits for the world in every turn",
        });
    }
    Err(format!("`{kind}` has no bound that a reader can see; write `for … in 0..CONSTANT`"))
}
