//! The tables of ARCHITECTURE.md that say what may depend on what.
//!
//! Their last column is headed `may depend on`. Folders stand between backquotes in the first cell, and what they may know in the
//! last one: folders, `everything`, or packages of others. A row that names a package of others names all of them. The longest
//! folder that holds a crate decides; within a row's own folders all may know one another, as far as no cycle comes of it.

use super::crates::Package;

/// How the last column is headed.
const HEADING: &str = "may depend on";
/// Allows all arrows.
const EVERYTHING: &str = "everything";

/// One row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    folders: Vec<String>,
    allowed: Vec<String>,
    /// Line in the document.
    pub line: usize,
}

/// An arrow that no row allows.
#[derive(Debug, PartialEq, Eq)]
pub struct Forbidden {
    pub from: String,
    pub to: String,
    /// The line of the row that speaks of `from`; 0: none does.
    pub line: usize,
}

/// All rows of all such tables.
pub fn rows_in(document: &str) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut within = false;
    for (index, line) in document.lines().enumerate() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let (Some(first), Some(last)) = (cells.first(), cells.last()) else { continue };
        if !line.trim_start().starts_with('|') {
            within = false;
        } else if *last == HEADING {
            within = true;
        } else if within {
            let folders: Vec<String> =
                quoted(first).map(|folder| folder.trim_end_matches('/').to_owned()).collect();
            let everything = (*last == EVERYTHING).then(|| EVERYTHING.to_owned());
            let named = quoted(last).map(|name| name.trim_end_matches('/').to_owned());
            let allowed = named.chain(everything).collect();
            if !folders.is_empty() {
                rows.push(Row { folders, allowed, line: index + 1 });
            }
        }
    }
    rows
}

fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// The folder is this one or lies in it.
fn within(folder: &str, outer: &str) -> bool {
    folder.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

impl Row {
    /// How much of the path of a crate it names.
    fn length(&self, folder: &str) -> Option<usize> {
        self.folders.iter().filter(|own| within(folder, own)).map(String::len).max()
    }

    fn allows(&self, folder: &str) -> bool {
        let known = self.folders.iter().chain(&self.allowed);
        self.allowed.iter().any(|name| name == EVERYTHING)
            || known.into_iter().any(|name| within(folder, name))
    }

    /// The packages of others, where the row names any.
    fn others<'a>(&'a self, packages: &[Package]) -> Option<Vec<&'a String>> {
        let is_folder = |name: &String| packages.iter().any(|package| within(&package.folder, name));
        let others = self.allowed.iter().filter(|name| !is_folder(name) && *name != EVERYTHING);
        let others: Vec<&String> = others.collect();
        (!others.is_empty()).then_some(others)
    }
}

/// Every arrow that no row allows, and every crate that no row speaks of.
pub fn forbidden(packages: &[Package], rows: &[Row]) -> Vec<Forbidden> {
    let mut found = Vec::new();
    for package in packages {
        let rows = rows.iter().filter_map(|row| Some((row.length(&package.folder)?, row)));
        let Some((_, row)) = rows.max_by_key(|(length, _)| *length) else {
            let (from, to) = (package.folder.clone(), String::new());
            found.push(Forbidden { from, to, line: 0 });
            continue;
        };
        let folder_of = |name: &String| packages.iter().find(|one| one.name == *name).map(|one| &one.folder);
        let own = package.own.iter().filter_map(folder_of).filter(|folder| !row.allows(folder));
        let others = row.others(packages).map(|allowed| {
            package.others.iter().filter(move |name| !allowed.contains(name)).collect::<Vec<_>>()
        });
        for to in own.chain(others.into_iter().flatten()) {
            found.push(Forbidden { from: package.folder.clone(), to: to.clone(), line: row.line });
        }
    }
    found
}
