//! Files of sources, parsed.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};

use super::crates::crates;
use crate::facts::facts;

/// One parsed file. Test modules are cut out: they run on the host only.
pub struct SourceFile {
    /// Path from the workspace root, with forward slashes.
    pub path: String,
    /// Its text, for the remarks that syntax does not keep.
    pub text: String,
    /// Its syntax without test code.
    pub syntax: syn::File,
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

/// `tests.rs`, `foo_tests.rs` or anything below a folder `tests` or `foo_tests`: declared under `cfg(test)` by their
/// parents, which `is_test_item` cannot see from inside the file.
pub fn is_test_file(path: &Path) -> bool {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let is_of_tests = |name: &str| name == "tests" || name.ends_with("_tests");
    is_of_tests(&stem) || path.components().any(|part| is_of_tests(&part.as_os_str().to_string_lossy()))
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
