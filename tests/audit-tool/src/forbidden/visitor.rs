//! What must not stand in the audited layers: unsafe code, the heap, panics, recursion, calls through pointers.
//!
//! The compiled image is the stronger evidence for panics, recursion and the heap; this one names the line.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use crate::claim::Finding;
use crate::forbidden::words::{
    ASSEMBLING_MACROS, HEAP_NAMES, OPERATORS, PANICKING_MACROS, PANICKING_METHODS, PANICKING_SLICES,
    UNSAFE_ATTRIBUTES,
};
use crate::loops::shown;
use crate::sources::{SourceFile, is_test_only, macros};

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

/// Searches one file.
pub fn inspect(file: &SourceFile, into: &mut Forbidden) {
    let mut imports = FixedCapacity::default();
    imports.visit_file(&file.syntax);
    let fixed = imports.0;
    let mut visitor = Visitor { file, into, functions: vec![], owner: None, fixed, constant: false };
    visitor.visit_file(&file.syntax);
    visitor.crate_attributes();
}

/// What the file imports of fixed capacity, so that `Vec` or `String` means that one.
#[derive(Default)]
struct FixedCapacity(Vec<&'static str>);

impl<'ast> Visit<'ast> for FixedCapacity {
    fn visit_use_path(&mut self, import: &'ast syn::UsePath) {
        let text = shown(&import.tree);
        let names: Vec<&str> = text.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        if import.ident == "heapless" {
            self.0.extend(["Vec", "String"].into_iter().filter(|name| names.contains(name)));
        }
    }
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
    /// Names that mean something of fixed capacity here.
    fixed: Vec<&'static str>,
    /// Inside what the compiler computes: a panic there fails the build, never the robot.
    constant: bool,
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
        let grows = name == "Vec" || HEAP_NAMES.contains(&name.as_str());
        if grows && !self.fixed.contains(&name.as_str()) {
            let finding = self.finding(identifier, format!("`{name}` needs the heap; use a fixed capacity"));
            self.into.heap.push(finding);
        }
    }

    /// What the compiler is asked to refuse stands at the head of each crate.
    fn crate_attributes(&mut self) {
        if !self.file.path.ends_with("src/lib.rs") {
            return;
        }
        let attributes: Vec<String> =
            self.file.syntax.attrs.iter().map(|attribute| shown(&attribute.meta)).collect();
        let missing = |text: &str| !attributes.iter().any(|attribute| attribute == text);
        let finding = |message: &str| Finding {
            place: self.file.path.clone(),
            line: 1,
            message: format!("`#![{message}]` is missing"),
        };
        if missing("forbid(unsafe_code)") {
            self.into.unsafe_code.push(finding("forbid(unsafe_code)"));
        }
        if missing("no_std") {
            self.into.heap.push(finding("no_std"));
        }
    }

    fn unsafe_finding(&mut self, at: &impl Spanned, what: &str) {
        let finding = self.finding(at, format!("{what}; the layer forbids unsafe code"));
        self.into.unsafe_code.push(finding);
    }

    fn panic_finding(&mut self, at: &impl Spanned, message: String) {
        if !self.constant {
            let finding = self.finding(at, message);
            self.into.panics.push(finding);
        }
    }

    fn within_constant(&mut self, visit: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.constant, true);
        visit(self);
        self.constant = outer;
    }

    /// What cannot be parsed, a rule of `macro_rules` above all, must not hold a forbidden word.
    fn words_of(&mut self, tokens: &proc_macro2::TokenStream) {
        for (word, line) in macros::words(tokens) {
            let place = self.file.path.clone();
            let finding = |message: String| Finding { place, line, message };
            let is = |names: &[&str]| names.contains(&word.as_str());
            if word == "unsafe" {
                self.into.unsafe_code.push(finding(String::from("`unsafe` inside a macro")));
            } else if word == "dyn" {
                self.into.pointers.push(finding(String::from("trait object inside a macro")));
            } else if is(PANICKING_METHODS) || is(PANICKING_MACROS) {
                self.into.panics.push(finding(format!("`{word}` inside a macro can panic")));
            } else if is(HEAP_NAMES)
                || is(&["vec", "format"])
                || word == "Vec" && !self.fixed.contains(&"Vec")
            {
                self.into.heap.push(finding(format!("`{word}` inside a macro needs the heap")));
            }
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
        if let Some(token) = &block.unsafety {
            self.unsafe_finding(token, "`unsafe impl`");
        }
        let owner = match &*block.self_ty {
            syn::Type::Path(path) => path.path.segments.last().map(|part| part.ident.to_string()),
            _ => None,
        };
        let outer = std::mem::replace(&mut self.owner, owner);
        visit::visit_item_impl(self, block);
        self.owner = outer;
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        if let Some(token) = &item.unsafety {
            self.unsafe_finding(token, "`unsafe trait`");
        }
        visit::visit_item_trait(self, item);
    }

    fn visit_item_foreign_mod(&mut self, block: &'ast syn::ItemForeignMod) {
        self.unsafe_finding(block, "functions that somebody else links");
    }

    fn visit_attribute(&mut self, attribute: &'ast syn::Attribute) {
        let text = shown(&attribute.meta);
        if UNSAFE_ATTRIBUTES.iter().any(|name| text.contains(name)) {
            self.unsafe_finding(attribute, &format!("`#[{text}]`"));
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.within_constant(|inner| visit::visit_item_const(inner, item));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.within_constant(|inner| visit::visit_impl_item_const(inner, item));
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        if let syn::StaticMutability::Mut(token) = &item.mutability {
            self.unsafe_finding(token, "`static mut`");
        }
        self.within_constant(|inner| visit::visit_item_static(inner, item));
    }

    fn visit_expr_const(&mut self, block: &'ast syn::ExprConst) {
        self.within_constant(|inner| visit::visit_expr_const(inner, block));
    }

    /// An array of known length refuses a wrong literal when it is compiled; clippy refuses it on a slice.
    fn visit_expr_index(&mut self, access: &'ast syn::ExprIndex) {
        if !is_fixed(&access.index) {
            self.panic_finding(access, format!("`{}` can panic; use `get`", shown(access)));
        }
        visit::visit_expr_index(self, access);
    }

    /// `a == b` inside of `eq` of the same value.
    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        let operator = shown(&binary.op);
        let method = OPERATORS.iter().find(|(sign, _)| *sign == operator).map(|(_, method)| *method);
        let inside = self.functions.last().filter(|inside| inside.method).map(|inside| inside.name.as_str());
        let left = shown(&binary.left);
        if method.is_some() && method == inside && left.trim_start_matches(['*', '&', ' ']) == "self" {
            let finding =
                self.finding(binary, format!("`{operator}` on itself calls the function around it"));
            self.into.recursion.push(finding);
        }
        visit::visit_expr_binary(self, binary);
    }

    /// `.map(Option::unwrap)` calls it without a dot.
    fn visit_expr_path(&mut self, path: &'ast syn::ExprPath) {
        if let (true, Some(last)) = (path.path.segments.len() > 1, path.path.segments.last())
            && PANICKING_METHODS.contains(&last.ident.to_string().as_str())
        {
            self.panic_finding(path, format!("`{}` can panic; handle the other case", shown(path)));
        }
        visit::visit_expr_path(self, path);
    }

    fn visit_expr_unsafe(&mut self, block: &'ast syn::ExprUnsafe) {
        self.unsafe_finding(block, "`unsafe` block");
        visit::visit_expr_unsafe(self, block);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let method = call.method.to_string();
        if PANICKING_METHODS.contains(&method.as_str()) {
            self.panic_finding(&call.method, format!("`{method}` can panic; handle the other case"));
        }
        if PANICKING_SLICES.contains(&method.as_str()) {
            self.panic_finding(&call.method, format!("`{method}` can panic; walk both with `zip`"));
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
        // Functions of one signature, picked at run time, become pointers without a type that says so.
        if !is_named(&call.func) {
            let message = format!("`{}` is picked at run time and called", shown(&call.func));
            let finding = self.finding(call, message);
            self.into.pointers.push(finding);
        }
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
            self.panic_finding(invocation, format!("`{name}!` can panic; return an error value"));
        }
        if ASSEMBLING_MACROS.contains(&name.as_str()) {
            self.unsafe_finding(invocation, &format!("`{name}!`"));
        }
        if name == "vec" || name == "format" {
            let finding = self.finding(invocation, format!("`{name}!` needs the heap; use a fixed capacity"));
            self.into.heap.push(finding);
        }
        visit::visit_macro(self, invocation);
        match macros::arguments(invocation) {
            Some(arguments) => arguments.iter().for_each(|argument| Visit::visit_expr(self, argument)),
            None => self.words_of(&invocation.tokens),
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let fixed = path.segments.first().is_some_and(|first| first.ident == "heapless");
        for segment in path.segments.iter().filter(|segment| !(fixed && segment.ident == "Vec")) {
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
        if !is_test_only(&import.attrs) {
            self.heap_name(&import.ident);
        }
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

/// A function, a closure or a field that holds one: its type says which.
fn is_named(function: &syn::Expr) -> bool {
    match function {
        syn::Expr::Path(_) | syn::Expr::Field(_) | syn::Expr::Closure(_) => true,
        syn::Expr::Paren(inner) => is_named(&inner.expr),
        _ => false,
    }
}

/// A number or a constant, or a range of them.
fn is_fixed(index: &syn::Expr) -> bool {
    let end = |end: &Option<Box<syn::Expr>>| end.as_ref().is_none_or(|end| is_fixed(end));
    match index {
        syn::Expr::Lit(_) => true,
        syn::Expr::Path(path) => path.path.segments.last().is_some_and(|last| {
            last.ident.to_string().chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
        }),
        syn::Expr::Range(range) => end(&range.start) && end(&range.end),
        _ => false,
    }
}
