//! Which top module of a crate names which, read from `use` and from paths.
//!
//! The root of a crate (`lib.rs`, `main.rs`) declares and hands on; a name that it hands on counts as one of the module that it is
//! from. Test code is left out.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};

use super::graph::Graph;
use crate::sources::{SourceFile, is_test_only, macros, paths_of};

/// The modules of one crate.
#[derive(Debug, Default)]
pub struct Modules {
    pub graph: Graph,
    /// Where one names another first: file and line.
    pub places: BTreeMap<(String, String), (String, usize)>,
}

/// Reads a crate: its name as code says it, the folder of its sources, and these.
pub fn read(ident: &str, folder: &str, files: &[SourceFile]) -> Modules {
    let own: Vec<(&SourceFile, Vec<String>)> =
        files.iter().filter_map(|file| Some((file, module_path(folder, &file.path)?))).collect();
    let mut found = Modules::default();
    let tops: BTreeSet<String> = own.iter().filter_map(|(_, path)| path.first().cloned()).collect();
    tops.iter().for_each(|top| found.graph.add(top));
    let handed_on = handed_on(&own, &tops);
    for (file, path) in own.iter().filter(|(_, path)| !path.is_empty()) {
        let scope = Scope { ident, tops: &tops, handed_on: &handed_on };
        let mut visitor = Visitor { scope, file, inside: path.clone(), found: &mut found };
        visitor.visit_file(&file.syntax);
    }
    found
}

/// The modules around the code of a file; none for a root, nothing for a file elsewhere.
fn module_path(folder: &str, file: &str) -> Option<Vec<String>> {
    let rest = file.strip_prefix(folder)?.strip_prefix('/')?.strip_suffix(".rs")?;
    let mut path: Vec<String> = rest.split('/').map(str::to_owned).collect();
    if path.last().is_some_and(|name| name == "mod") {
        path.pop();
    }
    let is_root = matches!(path.as_slice(), [name] if name == "lib" || name == "main");
    Some(if is_root || path.first().is_some_and(|name| name == "bin") { vec![] } else { path })
}

/// Names that the root hands on, with the module that each is from.
fn handed_on(own: &[(&SourceFile, Vec<String>)], tops: &BTreeSet<String>) -> BTreeMap<String, String> {
    let mut names = BTreeMap::new();
    for (file, _) in own.iter().filter(|(_, path)| path.is_empty()) {
        for path in exports(file) {
            let path: Vec<&String> = path.iter().filter(|name| *name != "crate" && *name != "self").collect();
            let (Some(top), Some(name)) = (path.first(), path.last()) else { continue };
            if tops.contains(*top) && *name == "*" {
                let module = own.iter().filter(|(_, path)| path.len() == 1 && path[0] == **top);
                let all = module.flat_map(|(file, _)| public_names(file));
                names.extend(all.map(|name| (name, (*top).clone())));
            } else if tops.contains(*top) {
                names.insert((*name).clone(), (*top).clone());
            }
        }
    }
    names
}

fn exports(file: &SourceFile) -> Vec<Vec<String>> {
    let items = file.syntax.items.iter().filter_map(|item| match item {
        syn::Item::Use(item) if !matches!(item.vis, syn::Visibility::Inherited) => Some(&item.tree),
        _ => None,
    });
    items.flat_map(paths_of).collect()
}

/// What `use module::*` brings.
fn public_names(file: &SourceFile) -> Vec<String> {
    let items = file.syntax.items.iter().filter_map(|item| match item {
        syn::Item::Struct(item) => Some(item.ident.to_string()),
        syn::Item::Enum(item) => Some(item.ident.to_string()),
        syn::Item::Trait(item) => Some(item.ident.to_string()),
        syn::Item::Type(item) => Some(item.ident.to_string()),
        syn::Item::Const(item) => Some(item.ident.to_string()),
        syn::Item::Fn(item) => Some(item.sig.ident.to_string()),
        _ => None,
    });
    items.chain(exports(file).into_iter().filter_map(|path| path.last().cloned())).collect()
}

/// How names are resolved.
struct Scope<'a> {
    ident: &'a str,
    tops: &'a BTreeSet<String>,
    handed_on: &'a BTreeMap<String, String>,
}

impl Scope<'_> {
    /// The top module that a path from the root leads to.
    fn top_of(&self, from_root: &[String]) -> Option<String> {
        let first = from_root.first()?;
        self.tops.get(first).or_else(|| self.handed_on.get(first)).cloned()
    }

    /// The top module that a path leads to, seen from within some modules. Names that are no path from the root or upwards are
    /// local or of another crate.
    fn resolve(&self, inside: &[String], path: &[String]) -> Option<String> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => self.top_of(rest),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                let outer = inside.get(..inside.len().checked_sub(up)?)?;
                self.top_of(&[outer, path.get(up..)?].concat())
            }
            name if name == self.ident => self.top_of(rest),
            _ => None,
        }
    }
}

struct Visitor<'a> {
    scope: Scope<'a>,
    file: &'a SourceFile,
    inside: Vec<String>,
    found: &'a mut Modules,
}

impl Visitor<'_> {
    fn named(&mut self, path: &[String], line: usize) {
        let Some(own) = self.inside.first().cloned() else { return };
        if let Some(other) = self.scope.resolve(&self.inside, path).filter(|other| *other != own) {
            self.found.graph.point(&own, &other);
            self.found.places.entry((own, other)).or_insert((self.file.path.clone(), line));
        }
    }

    /// `crate::name` among tokens that are no expressions.
    fn tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        for (at, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(word) if word == "crate" || word == self.scope.ident => {
                    if let Some(TokenTree::Ident(name)) = tokens.get(at + 3) {
                        let line = word.span().start().line;
                        self.named(&[String::from("crate"), name.to_string()], line);
                    }
                }
                _ => {}
            }
        }
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if !is_test_only(&module.attrs) {
            self.inside.push(module.ident.to_string());
            visit::visit_item_mod(self, module);
            self.inside.pop();
        }
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        if !is_test_only(&function.attrs) {
            visit::visit_item_fn(self, function);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !is_test_only(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_item_use(&mut self, import: &'ast syn::ItemUse) {
        use syn::spanned::Spanned as _;
        if !is_test_only(&import.attrs) {
            let line = import.span().start().line;
            paths_of(&import.tree).iter().for_each(|path| self.named(path, line));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|part| part.ident.to_string()).collect();
        let line = path.segments.first().map_or(0, |part| part.ident.span().start().line);
        self.named(&names, line);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        match macros::arguments(invocation) {
            Some(arguments) => arguments.iter().for_each(|argument| self.visit_expr(argument)),
            None => self.tokens(invocation.tokens.clone()),
        }
        self.visit_path(&invocation.path);
    }
}
