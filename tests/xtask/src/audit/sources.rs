//! The sources of the crates that the audit covers, parsed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Context, Result, anyhow};
use proc_macro2::{Group, TokenStream, TokenTree};

use crate::facts::facts;
use crate::shell;

/// One parsed file. Test modules are cut out: they run on the host only.
pub struct SourceFile {
    /// Path from the workspace root, with forward slashes.
    pub path: String,
    /// Its text, for the remarks that syntax does not keep.
    pub text: String,
    /// Its syntax without test code.
    pub syntax: syn::File,
}

/// A crate that is audited.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crate {
    /// Folder from the workspace root, with forward slashes.
    pub folder: String,
    /// Name of the package.
    pub package: String,
}

static CRATES: LazyLock<Vec<Crate>> = LazyLock::new(|| {
    crates_below(&shell::root(), &facts().sources.audited).unwrap_or_else(|error| panic!("{error:#}"))
});

/// The audited crates, in the order of their folders.
pub fn crates() -> &'static [Crate] {
    &CRATES
}

/// Every crate at or below some folders.
pub fn crates_below(root: &Path, folders: &[String]) -> Result<Vec<Crate>> {
    let mut found = Vec::new();
    for folder in folders {
        collect_crates(root, folder, &mut found)?;
    }
    found.sort_by(|a, b| a.folder.cmp(&b.folder));
    Ok(found)
}

fn collect_crates(root: &Path, folder: &str, found: &mut Vec<Crate>) -> Result<()> {
    if let Ok(text) = fs::read_to_string(root.join(folder).join("Cargo.toml")) {
        let manifest: toml::Table = toml::from_str(&text).with_context(|| format!("{folder}/Cargo.toml"))?;
        let name = manifest.get("package").and_then(|package| package.get("name")?.as_str());
        let package = name.with_context(|| format!("{folder}/Cargo.toml names no package"))?.to_owned();
        found.push(Crate { folder: folder.to_owned(), package });
    }
    let entries = fs::read_dir(root.join(folder)).with_context(|| format!("cannot list {folder}"))?;
    for entry in entries.filter_map(Result::ok).filter(|entry| entry.path().is_dir()) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !["target", "src", "tests", "examples", "benches"].contains(&name.as_str()) {
            collect_crates(root, &format!("{folder}/{name}"), found)?;
        }
    }
    Ok(())
}

/// The folder of an audited package.
pub fn folder_of(package: &str) -> Result<&'static str> {
    let found = crates().iter().find(|one| one.package == package);
    Ok(&found.with_context(|| format!("{package} is no audited package"))?.folder)
}

/// How code names a package.
pub fn ident_of(package: &str) -> String {
    package.replace('-', "_")
}

/// The audited crate that holds a file, and the rest of the path behind its `src`.
pub fn within(file: &str) -> Option<(&'static Crate, &str)> {
    crates().iter().find_map(|one| {
        let rest = file.strip_prefix(&one.folder)?.strip_prefix("/src/")?;
        Some((one, rest))
    })
}

/// The file belongs to an audited crate.
pub fn is_own(file: &str) -> bool {
    within(file).is_some()
}

/// The top module that holds a file, as a path: the folder or the file behind `src`. Of a file elsewhere, its folder.
pub fn module_of(file: &str) -> String {
    match within(file) {
        Some((one, rest)) => {
            let top = rest.split('/').next().unwrap_or(rest).trim_end_matches(".rs");
            format!("{}/src/{top}", one.folder)
        }
        None => file.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned(),
    }
}

/// All source files of the audited crates, in the order of their paths.
pub fn read_audited(root: &Path) -> Result<Vec<SourceFile>> {
    let folders: Vec<String> = crates().iter().map(|one| format!("{}/src", one.folder)).collect();
    read_folders(root, &folders)
}

/// All source files below some folders, in the order of their paths.
pub fn read_folders(root: &Path, folders: &[String]) -> Result<Vec<SourceFile>> {
    let mut paths = Vec::new();
    for folder in folders {
        collect(&root.join(folder), &mut paths)?;
    }
    paths.sort();
    paths
        .iter()
        .filter(|path| !is_test_file(path.strip_prefix(root).unwrap_or(path)))
        .map(|path| {
            let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
            let name = path.strip_prefix(root).unwrap_or(path).to_string_lossy().replace('\\', "/");
            parse(&name, text)
        })
        .collect()
}

/// All that the robot and its simulator are made of.
pub fn read_robot(root: &Path) -> Result<Vec<SourceFile>> {
    read_folders(root, &facts().sources.robot)
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
pub fn without_docs(tokens: TokenStream) -> TokenStream {
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
    collect(&root.join(&facts().image.sources), &mut paths)?;
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
pub fn is_test_file(path: &Path) -> bool {
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
    fn audited_crates_are_found_with_their_top_modules() {
        assert_eq!(folder_of("floorguard-guard").expect("it is audited"), "core-nostd/guard");
        assert!(folder_of("floorguard-sim").is_err() && crates().len() >= 8);
        assert!(is_own("drivers/src/lib.rs") && !is_own("drivers/build.rs") && !is_own("hal-sim/src/lib.rs"));
        assert_eq!(module_of("core-nostd/guard/src/decide.rs"), "core-nostd/guard/src/decide");
        assert_eq!(module_of("drivers/src/s300/receiver.rs"), "drivers/src/s300");
    }

    #[test]
    fn the_fingerprint_is_of_what_the_code_does() {
        let of = |text: &str| {
            fingerprint(&[parse("core-nostd/types/src/a.rs", text.to_owned()).expect("it parses")])
        };
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
