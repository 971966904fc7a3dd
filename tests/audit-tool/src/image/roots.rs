//! The roots of the safety image: its functions `root_…`, each the work that a task does for one input.

use std::path::Path;

use anyhow::Result;
use syn::visit::{self, Visit};

use crate::facts::facts;
use crate::sources;

/// A root as its source writes it down.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Root {
    /// File from the workspace root.
    pub file: String,
    /// Line of its name.
    pub line: usize,
    /// Its name.
    pub name: String,
}

/// The last part of the path of a function.
pub fn short(function: &str) -> &str {
    function.rsplit("::").next().unwrap_or(function)
}

/// A function of the linked image is one of the roots. What is within a root, as a closure is, is none, nor is a function of
/// the core that happens to begin in the same way.
pub fn is_root(function: &str, roots: &[Root]) -> bool {
    roots.iter().any(|root| root.name == short(function))
}

/// The roots of the safety image, in the order of its files.
pub fn of_the_image(root: &Path) -> Result<Vec<Root>> {
    let files = sources::of_the_image(root)?;
    let each = files.into_iter().map(|(file, text)| in_text(&file, text));
    Ok(each.collect::<Result<Vec<_>>>()?.concat())
}

/// The roots of one file, whatever stands before their `fn`.
pub fn in_text(file: &str, text: String) -> Result<Vec<Root>> {
    let syntax = sources::parse(file, text)?.syntax;
    let mut visitor = Visitor { file, found: vec![] };
    visitor.visit_file(&syntax);
    Ok(visitor.found)
}

struct Visitor<'a> {
    file: &'a str,
    found: Vec<Root>,
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    /// Of every function, free or of a type.
    fn visit_signature(&mut self, signature: &'ast syn::Signature) {
        let name = signature.ident.to_string();
        if name.starts_with(&facts().image.stage) {
            let line = signature.ident.span().start().line;
            self.found.push(Root { file: self.file.to_owned(), line, name });
        }
        visit::visit_signature(self, signature);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_whatever_stands_before_them() {
        let text = "fn root_a() {}\npub fn root_b<T>(t: T) {}\n#[inline(never)]\npub(crate) extern \"C\" fn root_c() {}\n\
                    mod m { unsafe fn root_d() {} }\nimpl T { pub const fn root_e(&self) {} }\n\
                    // fn root_no() {}\nfn uproot_no() { root_a() }\n#[cfg(test)]\nmod tests { fn root_no() {} }\n";
        let found = in_text("a.rs", text.to_owned()).expect("it parses");
        let found: Vec<_> = found.iter().map(|root| (root.line, root.name.as_str())).collect();
        assert_eq!(found, [(1, "root_a"), (2, "root_b"), (4, "root_c"), (5, "root_d"), (6, "root_e")]);
    }

    #[test]
    fn only_what_the_sources_name_is_a_root() {
        let roots = in_text("a.rs", "fn root_s300() {}".to_owned()).expect("it parses");
        assert!(is_root("image::drivers::root_s300", &roots) && is_root("root_s300", &roots));
        assert!(!is_root("floorguard_types::labels::union::root_of", &roots));
        assert!(!is_root("image::root_s300::{{closure}}", &roots));
    }
}
