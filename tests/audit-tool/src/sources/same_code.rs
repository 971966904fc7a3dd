//! Whether code is the same but for its place: syntax without layout, remarks, visibility, imports and the modules before a name.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use quote::ToTokens as _;
use syn::visit::{self, Visit};

use crate::sources;
use crate::sources::SourceFile;

/// The functions of a tree.
#[derive(Default)]
pub struct Functions {
    /// By file and name: the syntax of all functions of that name, and their text.
    by_name: BTreeMap<(String, String), (String, String)>,
}

impl Functions {
    /// The syntax of the functions of that name.
    pub fn named(&self, file: &str, name: &str) -> Option<&str> {
        self.by_name.get(&(file.to_owned(), name.to_owned())).map(|(syntax, _)| syntax.as_str())
    }

    /// The names of the functions of a file in whose text a line stands.
    pub fn holding(&self, file: &str, line: &str) -> Vec<String> {
        let own = self.by_name.iter().filter(|((of, _), (_, text))| of == file && text.contains(line));
        own.map(|((_, name), _)| name.clone()).collect()
    }

    /// All files.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.by_name.keys().map(|(file, _)| file.as_str()).collect::<BTreeSet<_>>().into_iter()
    }
}

/// Reads the functions of all files.
pub fn functions(files: &[SourceFile]) -> Functions {
    let mut functions = Functions::default();
    for file in files {
        Visitor { file, functions: &mut functions }.visit_file(&file.syntax);
    }
    functions
}

struct Visitor<'a> {
    file: &'a SourceFile,
    functions: &'a mut Functions,
}

impl Visitor<'_> {
    fn keep(&mut self, name: &syn::Ident, tokens: TokenStream) {
        use syn::spanned::Spanned as _;
        let text = self.file.text.get(tokens.span().byte_range()).unwrap_or_default().to_owned();
        let key = (self.file.path.clone(), name.to_string());
        let (syntax, texts) = self.functions.by_name.entry(key).or_default();
        *syntax += &plain(tokens);
        *texts += &text;
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.keep(&function.sig.ident, function.to_token_stream());
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.keep(&function.sig.ident, function.to_token_stream());
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.keep(&function.sig.ident, function.to_token_stream());
        visit::visit_trait_item_fn(self, function);
    }
}

/// Files that say something else than before, by their new names or, where they are gone, by their old ones.
pub fn differences(
    old: &[SourceFile],
    new: &[SourceFile],
    names: &BTreeMap<String, String>,
) -> BTreeSet<String> {
    let read = |files: &[SourceFile], name: &dyn Fn(&String) -> String| {
        let texts = files.iter().map(|file| (name(&file.path), all_of(file)));
        texts.filter(|(_, text)| !text.is_empty()).collect::<BTreeSet<_>>()
    };
    let before = read(old, &|path| names.get(path).unwrap_or(path).clone());
    let now = read(new, &String::clone);
    before.symmetric_difference(&now).map(|(name, _)| name.clone()).collect()
}

/// What a file says besides importing, declaring modules and setting lints.
fn all_of(file: &SourceFile) -> String {
    let has_content = |item: &&syn::Item| match item {
        syn::Item::Use(_) | syn::Item::ExternCrate(_) => false,
        syn::Item::Mod(module) => module.content.is_some(),
        _ => true,
    };
    let items = file.syntax.items.iter().filter(has_content);
    items.map(|item| plain(item.to_token_stream())).collect()
}

fn plain(tokens: TokenStream) -> String {
    without_places(sources::without_docs(tokens)).to_string()
}

/// Leaves out `pub`, `pub(crate)` and the modules before a name: those words are written small and `::` follows.
fn without_places(tokens: TokenStream) -> TokenStream {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let is = |at: usize, sign: &str| tokens.get(at).is_some_and(|token| token.to_string() == sign);
    let mut kept: Vec<TokenTree> = Vec::new();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token {
            TokenTree::Ident(word) if word == "pub" => {
                let next = tokens.get(at);
                let scope = |group: &Group| group.delimiter() == Delimiter::Parenthesis;
                at += usize::from(matches!(next, Some(TokenTree::Group(group)) if scope(group)));
            }
            TokenTree::Ident(word) if is_module(&word.to_string()) && is(at, ":") && is(at + 1, ":") => {
                at += 2;
            }
            TokenTree::Group(group) => {
                kept.push(Group::new(group.delimiter(), without_places(group.stream())).into());
            }
            other => kept.push(other.clone()),
        }
    }
    kept.into_iter().collect()
}

fn is_module(word: &str) -> bool {
    let is_number = ["u8", "u16", "u32", "u64", "i8", "i16", "i32", "i64", "f32", "f64", "usize", "isize"]
        .contains(&word);
    !is_number && word.starts_with(|letter: char| letter.is_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> SourceFile {
        sources::parse(name, text.to_owned()).expect("it parses")
    }

    #[test]
    fn only_a_move_is_no_difference() {
        let names = BTreeMap::from([(String::from("a.rs"), String::from("b.rs"))]);
        let old = [file("a.rs", "use crate::c::D;\npub fn f(d: D) -> u8 { crate::c::g(d) + u8::MAX }")];
        let differs = |text: &str| !differences(&old, &[file("b.rs", text)], &names).is_empty();
        assert!(!differs("use e::D;\n/// Says so.\npub(crate) fn f(d: D) -> u8 { e::h::g(d) + u8::MAX }"));
        assert!(differs("pub fn f(d: D) -> u8 { crate::c::g(d) + u16::MAX }"));
        assert!(differs("pub fn f(d: D) -> u8 { crate::c::g(d) - u8::MAX }"));
        assert!(differs("pub fn f(d: D) -> u8 { crate::c::g(d) + u8::MAX }\nfn more() {}"));
        assert!(!differences(&old, &[], &names).is_empty());
    }
}
