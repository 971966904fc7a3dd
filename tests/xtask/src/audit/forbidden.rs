//! What must not stand in the audited layers: unsafe code, the heap, panics, recursion, calls through pointers.
//!
//! The compiled image is the stronger witness for panics, recursion and the heap; this one names the line.

use std::collections::{BTreeMap, BTreeSet};

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use super::claim::Finding;
use super::sources::{SourceFile, is_test_only};

const PANICKING_METHODS: &[&str] = &["unwrap", "expect", "unwrap_err", "expect_err"];
const PANICKING_MACROS: &[&str] =
    &["panic", "unreachable", "todo", "unimplemented", "assert", "assert_eq", "assert_ne"];
const HEAP_NAMES: &[&str] = &["alloc", "Box", "String", "Rc", "Arc", "BTreeMap", "HashMap", "VecDeque"];

/// Findings by topic.
#[derive(Default)]
pub struct Forbidden {
    /// Unsafe code.
    pub unsafe_code: Vec<Finding>,
    /// Anything that needs an allocator.
    pub heap: Vec<Finding>,
    /// Anything that can panic by its name.
    pub panics: Vec<Finding>,
    /// Function pointers and trait objects.
    pub pointers: Vec<Finding>,
    /// Functions that call themselves.
    pub recursion: Vec<Finding>,
}

/// Looks through one file.
pub fn inspect(file: &SourceFile, into: &mut Forbidden) {
    let imports_fixed_vec = file.text.contains("heapless");
    let mut visitor = Visitor { file, into, functions: vec![], owner: None, imports_fixed_vec };
    visitor.visit_file(&file.syntax);
}

/// A function, and how it can be called: a method only through a value or its type, a free function only by its path.
struct Named {
    name: String,
    method: bool,
}

struct Visitor<'a> {
    file: &'a SourceFile,
    into: &'a mut Forbidden,
    /// Functions that enclose what is being looked at, innermost last.
    functions: Vec<Named>,
    /// Type of the `impl` block around it.
    owner: Option<String>,
    imports_fixed_vec: bool,
}

impl Visitor<'_> {
    fn finding(&self, at: &impl Spanned, message: String) -> Finding {
        Finding { place: self.file.path.clone(), line: at.span().start().line, message }
    }

    /// A call by path leads back to the innermost function: `name(…)` to a free one, `Self::name(…)` or
    /// `Type::name(…)` to a method. The call graph of the image finds what goes round over several functions.
    fn is_the_function_itself(&self, segments: &[String]) -> bool {
        let Some(inside) = self.functions.last() else { return false };
        match segments {
            [name] | [.., _, name] if *name != inside.name => false,
            [_] => !inside.method,
            [.., owner, _] if inside.method => owner == "Self" || Some(owner) == self.owner.as_ref(),
            [owner, _] => owner == "self",
            _ => false,
        }
    }

    fn heap_name(&mut self, identifier: &syn::Ident) {
        let name = identifier.to_string();
        let growing_vec = name == "Vec" && !self.imports_fixed_vec;
        if HEAP_NAMES.contains(&name.as_str()) || growing_vec {
            let finding = self.finding(identifier, format!("`{name}` needs the heap; use a fixed capacity"));
            self.into.heap.push(finding);
        }
    }

    fn inside(&mut self, signature: &syn::Signature, method: bool, visit: impl FnOnce(&mut Self)) {
        if let syn::Safety::Unsafe(token) = &signature.safety {
            let finding = self.finding(token, String::from("`unsafe fn`; the layer forbids unsafe code"));
            self.into.unsafe_code.push(finding);
        }
        self.functions.push(Named { name: signature.ident.to_string(), method });
        visit(self);
        self.functions.pop();
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
            self.inside(&function.sig, false, |inner| visit::visit_item_fn(inner, function));
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !is_test_only(&function.attrs) {
            self.inside(&function.sig, true, |inner| visit::visit_impl_item_fn(inner, function));
        }
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.inside(&function.sig, true, |inner| visit::visit_trait_item_fn(inner, function));
    }

    fn visit_item_impl(&mut self, block: &'ast syn::ItemImpl) {
        let owner = match &*block.self_ty {
            syn::Type::Path(path) => path.path.segments.last().map(|part| part.ident.to_string()),
            _ => None,
        };
        let outer = std::mem::replace(&mut self.owner, owner);
        visit::visit_item_impl(self, block);
        self.owner = outer;
    }

    /// A constant is computed by the compiler: an assertion in it fails the build, never the robot.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}

    fn visit_expr_unsafe(&mut self, block: &'ast syn::ExprUnsafe) {
        let finding = self.finding(block, String::from("`unsafe` block; the layer forbids unsafe code"));
        self.into.unsafe_code.push(finding);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let method = call.method.to_string();
        if PANICKING_METHODS.contains(&method.as_str()) {
            let finding = self.finding(&call.method, format!("`{method}` can panic; handle the other case"));
            self.into.panics.push(finding);
        }
        let on_itself = matches!(&*call.receiver, syn::Expr::Path(path) if path.path.is_ident("self"));
        if on_itself && self.functions.last().is_some_and(|inside| inside.method && inside.name == method) {
            let finding =
                self.finding(&call.method, format!("`{method}` calls itself; write a bounded loop"));
            self.into.recursion.push(finding);
        }
        visit::visit_expr_method_call(self, call);
    }

    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        if let syn::Expr::Path(path) = &*call.func {
            let segments: Vec<String> =
                path.path.segments.iter().map(|part| part.ident.to_string()).collect();
            if self.is_the_function_itself(&segments) {
                let name = segments.last().cloned().unwrap_or_default();
                let finding = self.finding(call, format!("`{name}` calls itself; write a bounded loop"));
                self.into.recursion.push(finding);
            }
        }
        visit::visit_expr_call(self, call);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        let name = invocation.path.segments.last().map(|part| part.ident.to_string()).unwrap_or_default();
        if PANICKING_MACROS.contains(&name.as_str()) {
            let finding = self.finding(invocation, format!("`{name}!` can panic; return an error value"));
            self.into.panics.push(finding);
        }
        if name == "vec" || name == "format" {
            let finding = self.finding(invocation, format!("`{name}!` needs the heap; use a fixed capacity"));
            self.into.heap.push(finding);
        }
        visit::visit_macro(self, invocation);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        for segment in &path.segments {
            self.heap_name(&segment.ident);
        }
        visit::visit_path(self, path);
    }

    fn visit_use_path(&mut self, import: &'ast syn::UsePath) {
        self.heap_name(&import.ident);
        visit::visit_use_path(self, import);
    }

    fn visit_use_name(&mut self, import: &'ast syn::UseName) {
        self.heap_name(&import.ident);
    }

    fn visit_item_extern_crate(&mut self, import: &'ast syn::ItemExternCrate) {
        self.heap_name(&import.ident);
    }

    fn visit_type_fn_ptr(&mut self, pointer: &'ast syn::TypeFnPtr) {
        let finding = self.finding(pointer, String::from("function pointer; the call graph must be static"));
        self.into.pointers.push(finding);
    }

    fn visit_type_trait_object(&mut self, object: &'ast syn::TypeTraitObject) {
        let finding = self.finding(object, String::from("trait object; the call graph must be static"));
        self.into.pointers.push(finding);
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
