//! `cargo xtask figures`: the book's pages of measured figures, written from `docs/evidence/figures/*.json`.

mod cells;
mod overview;
mod page;
mod schema;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;

use crate::shell;

/// Where the figures are recorded, from the root of the workspace.
const RECORDS: &str = "docs/evidence/figures";
/// Where the pages lie.
const BOOK: &str = "docs/src";

/// What to do with the pages.
#[derive(Args)]
pub struct Options {
    /// Write nothing; exit code 1 if a page differs from what its record gives.
    #[arg(long)]
    check: bool,
}

/// A page and its text.
struct Written {
    path: PathBuf,
    text: String,
}

/// Writes every page, or names those that differ. False if one differs.
pub fn run(options: &Options) -> Result<bool> {
    let root = shell::root();
    if options.check {
        let differing = differing(&root)?;
        for path in &differing {
            println!("{} differs from {RECORDS}: run `cargo xtask figures`", path.display());
        }
        return Ok(differing.is_empty());
    }
    let pages = pages(&root)?;
    for page in &pages {
        let folder = page.path.parent().context("a page without a folder")?;
        std::fs::create_dir_all(folder)?;
        std::fs::write(&page.path, &page.text)
            .with_context(|| format!("cannot write {}", page.path.display()))?;
    }
    println!("{} pages written from {RECORDS}", pages.len());
    Ok(true)
}

/// All pages as the records give them: the overview first.
fn pages(root: &Path) -> Result<Vec<Written>> {
    let subjects = schema::read(&root.join(RECORDS))?;
    let book = root.join(BOOK);
    let overview = Written { path: book.join("figures.md"), text: overview::text(&subjects) };
    let page = |subject: &schema::Subject| Written {
        path: book.join("figures").join(format!("{}.md", subject.name)),
        text: page::text(subject),
    };
    Ok(std::iter::once(overview).chain(subjects.iter().map(page)).collect())
}

/// Pages that are absent, or other than the records give.
fn differing(root: &Path) -> Result<Vec<PathBuf>> {
    let pages = pages(root)?.into_iter();
    let differs = |page: &Written| std::fs::read_to_string(&page.path).ok().as_ref() != Some(&page.text);
    Ok(pages.filter(differs).map(|page| page.path).collect())
}
