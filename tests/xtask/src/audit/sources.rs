//! The sources of the layers that the audit covers, parsed.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use proc_macro2::{Group, TokenStream, TokenTree};

/// One parsed file. Test modules are cut out: they run on the host only.
pub struct SourceFile {
    /// Path from the workspace root, with forward slashes.
    pub path: String,
    /// Its text, for the remarks that syntax does not keep.
    pub text: String,
    /// Its syntax without test code.
    pub syntax: syn::File,
}

/// The layers of the safety image.
pub const LAYERS: [&str; 2] = ["core-nostd/src", "drivers/src"];

/// The file belongs to an audited layer.
pub fn is_own(file: &str) -> bool {
    LAYERS.iter().any(|layer| file.starts_with(layer))
}

/// All source files of the audited layers, in the order of their paths.
pub fn read_layers(root: &Path) -> Result<Vec<SourceFile>> {
    read_folders(root, &LAYERS)
}

/// All source files below some folders, in the order of their paths.
pub fn read_folders(root: &Path, folders: &[&str]) -> Result<Vec<SourceFile>> {
    let mut paths = Vec::new();
    for folder in folders {
        collect(&root.join(folder), &mut paths)?;
    }
    paths.sort();
    paths
        .iter()
        .filter(|path| !is_test_file(path))
        .map(|path| {
            let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
            let name = path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/");
            parse(&name, text)
        })
        .collect()
}

/// All that the robot and its simulator are made of.
pub fn read_whole(root: &Path) -> Result<Vec<SourceFile>> {
    read_folders(root, &["core-nostd/src", "drivers/src", "runtime", "hal-sim/src"])
}

/// A 64-bit fingerprint (FNV-1a) of what code does: their syntax without tests, remarks and layout. A record of a
/// long run keeps it, so that a reader sees whether the code has changed since.
pub fn fingerprint(files: &[SourceFile]) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for file in files {
        let tokens = without_docs(quote::ToTokens::to_token_stream(&file.syntax)).to_string();
        for byte in file.path.bytes().chain([0]).chain(tokens.bytes()).chain([0]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    format!("{hash:016x}")
}

/// Remarks for readers are attributes of the syntax: they change nothing, and are left out.
fn without_docs(tokens: TokenStream) -> TokenStream {
    let is_doc =
        |group: &Group| group.stream().into_iter().next().is_some_and(|token| token.to_string() == "doc");
    let mut kept: Vec<TokenTree> = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Group(group) if is_doc(&group) => {
                let sign = |token: &TokenTree| matches!(token.to_string().as_str(), "#" | "!");
                while kept.last().is_some_and(sign) {
                    kept.pop();
                }
            }
            TokenTree::Group(group) => {
                kept.push(Group::new(group.delimiter(), without_docs(group.stream())).into());
            }
            other => kept.push(other),
        }
    }
    kept.into_iter().collect()
}

/// The sources of the safety image, by their paths from the workspace root.
pub fn of_the_image(root: &Path) -> Result<Vec<(String, String)>> {
    let mut paths = Vec::new();
    collect(&root.join("tests/safety-image/src"), &mut paths)?;
    paths.sort();
    let read = |path: &PathBuf| {
        let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok((path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/"), text))
    };
    paths.iter().map(read).collect()
}

/// Parses one file and cuts its test code out.
pub fn parse(name: &str, text: String) -> Result<SourceFile> {
    let mut syntax = syn::parse_file(&text).map_err(|error| anyhow!("{name}: {error}"))?;
    syntax.items.retain(|item| !is_test_item(item));
    Ok(SourceFile { path: name.to_owned(), text, syntax })
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, paths)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
    Ok(())
}

/// `tests.rs`, `foo_tests.rs` or anything below a folder `tests`: declared under `cfg(test)` by their parents, which
/// `is_test_item` cannot see from inside the file.
fn is_test_file(path: &Path) -> bool {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    stem == "tests" || stem.ends_with("_tests") || path.components().any(|part| part.as_os_str() == "tests")
}

fn is_test_item(item: &syn::Item) -> bool {
    let attributes = match item {
        syn::Item::Mod(module) => &module.attrs,
        syn::Item::Fn(function) => &function.attrs,
        syn::Item::Impl(block) => &block.attrs,
        syn::Item::Use(import) => &import.attrs,
        syn::Item::Macro(invocation) => &invocation.attrs,
        _ => return false,
    };
    is_test_only(attributes)
}

/// The attributes say that the item exists under test only.
pub fn is_test_only(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || (attribute.path().is_ident("cfg")
                && attribute
                    .parse_args::<syn::Meta>()
                    .is_ok_and(|meta| meta.path().is_ident("test") || starts_with_all_test(&meta)))
    })
}

fn starts_with_all_test(meta: &syn::Meta) -> bool {
    match meta {
        syn::Meta::List(list) if list.path.is_ident("all") => {
            list.tokens.clone().into_iter().next().is_some_and(|token| token.to_string() == "test")
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingerprint_is_of_what_the_code_does() {
        let of =
            |text: &str| fingerprint(&[parse("core-nostd/src/a.rs", text.to_owned()).expect("it parses")]);
        let plain = of("fn f() -> u8 { 1 }");
        assert_eq!(
            plain,
            of(
                "//! Above.\n/// Says \"so\".\nfn f()\n -> u8 { 1 } // one\n#[cfg(test)]\nmod tests { fn g() {} }"
            )
        );
        assert_ne!(plain, of("fn f() -> u8 { 2 }"));
        assert_ne!(plain, of("fn g() -> u8 { 1 }"));
    }
}
