//! The table of the architecture that says what may depend on what.
//!
//! Its last column is headed `may depend on …`, and some column has the folders of the packages between backquotes. What a row
//! allows is a list, parted by commas: `types` (a package by the end of its name, or a top folder by the beginning of its name),
//! `host and below` (that package and whatever its own row allows), `everything above` (the packages of the rows above),
//! `everything`, `nothing`. What stands between brackets is for readers. The row of the longest folder that holds a package
//! decides.

use std::collections::BTreeSet;

use super::crates::Package;
use crate::facts::facts;

/// How the heading of the last column begins.
const HEADING: &str = "may depend on";

/// One row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    folders: Vec<String>,
    terms: Vec<String>,
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

/// The rows of the first such table.
pub fn rows_in(document: &str) -> Vec<Row> {
    let cells = |line: &str| -> Vec<String> {
        line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let lines = document.lines().enumerate();
    let mut lines =
        lines.skip_while(|(_, line)| !cells(line).last().is_some_and(|cell| cell.starts_with(HEADING)));
    lines.next();
    let rows = lines.take_while(|(_, line)| line.trim_start().starts_with('|'));
    let row = |(index, line): (usize, &str)| {
        let cells = cells(line);
        let (last, others) = cells.split_last()?;
        let folders: Vec<String> = others.iter().flat_map(|cell| folders_in(cell)).collect();
        let terms = without_brackets(last);
        let terms = terms.split(',').map(|term| term.trim().to_owned()).filter(|term| !term.is_empty());
        (!folders.is_empty()).then(|| Row { folders, terms: terms.collect(), line: index + 1 })
    };
    rows.filter_map(row).collect()
}

/// What stands between backquotes and is no name of a package of ours.
fn folders_in(cell: &str) -> Vec<String> {
    let quoted = cell.split('`').skip(1).step_by(2);
    let own = |name: &&str| !name.contains('/') && name.starts_with(&facts().own_packages);
    quoted.filter(|name| !own(name)).map(|name| name.trim_end_matches('/').to_owned()).collect()
}

fn without_brackets(text: &str) -> String {
    let mut depth = 0_usize;
    let outside = |letter: &char| {
        depth += usize::from(*letter == '(');
        let kept = depth == 0;
        depth -= usize::from(*letter == ')' && depth > 0);
        kept && *letter != '`'
    };
    text.chars().filter(outside).collect()
}

/// The folder is this one or lies in it.
fn within(folder: &str, outer: &str) -> bool {
    folder.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Answers from the table.
struct Table<'a> {
    packages: &'a [Package],
    rows: &'a [Row],
}

impl Table<'_> {
    /// The row that decides over a folder.
    fn row_of(&self, folder: &str) -> Option<usize> {
        let length = |row: &Row| row.folders.iter().filter(|own| within(folder, own)).map(String::len).max();
        let rows = self.rows.iter().enumerate().filter_map(|(at, row)| Some((length(row)?, at)));
        rows.max_by_key(|(length, _)| *length).map(|(_, at)| at)
    }

    /// Folders of the packages whose row is one of these.
    fn of_rows(&self, wanted: impl Fn(usize) -> bool) -> BTreeSet<&str> {
        let folders = self.packages.iter().map(|package| package.folder.as_str());
        folders.filter(|folder| self.row_of(folder).is_some_and(&wanted)).collect()
    }

    /// Folders that a word names.
    fn named(&self, word: &str) -> BTreeSet<&str> {
        let ending = word.replace(' ', "-");
        let is_meant = |package: &&Package| {
            let is_package = package.name == ending
                || package.name.strip_prefix(&facts().own_packages) == Some(&format!("-{ending}"));
            let top = package.folder.split('/').next().unwrap_or_default();
            let is_folder = top == ending || top.split('-').next() == Some(&ending);
            is_package
                || is_folder && !self.packages.iter().any(|one| one.name.ends_with(&format!("-{ending}")))
        };
        self.packages.iter().filter(is_meant).map(|package| package.folder.as_str()).collect()
    }

    /// Folders that a row allows. Rows may refer to rows above only, so that this comes to an end.
    fn allowed(&self, at: usize) -> BTreeSet<&str> {
        let mut folders = self.of_rows(|row| row == at);
        for term in self.rows.get(at).into_iter().flat_map(|row| &row.terms) {
            match term.as_str() {
                "nothing" => {}
                "everything" => folders.extend(self.packages.iter().map(|package| package.folder.as_str())),
                "everything above" => folders.extend(self.of_rows(|row| row < at)),
                term => match term.strip_suffix(" and below") {
                    None => folders.extend(self.named(term)),
                    Some(name) => {
                        let named = self.named(name);
                        let rows: BTreeSet<usize> =
                            named.iter().filter_map(|folder| self.row_of(folder)).collect();
                        folders.extend(named);
                        rows.iter()
                            .filter(|row| **row < at)
                            .for_each(|row| folders.extend(self.allowed(*row)));
                    }
                },
            }
        }
        folders
    }
}

/// Every arrow that no row allows, and every package that no row speaks of.
pub fn forbidden(packages: &[Package], rows: &[Row]) -> Vec<Forbidden> {
    let table = Table { packages, rows };
    let mut found = Vec::new();
    for package in packages {
        let from = &package.folder;
        let Some(at) = table.row_of(from) else {
            found.push(Forbidden { from: from.clone(), to: String::new(), line: 0 });
            continue;
        };
        let allowed = table.allowed(at);
        let line = rows.get(at).map_or(0, |row| row.line);
        let folder_of = |name: &String| packages.iter().find(|one| one.name == *name).map(|one| &one.folder);
        let own =
            package.own.iter().filter_map(folder_of).filter(|folder| !allowed.contains(folder.as_str()));
        for to in own.chain(others(package)) {
            found.push(Forbidden { from: from.clone(), to: to.clone(), line });
        }
    }
    found
}

/// Packages of others that the facts do not allow below the package's folder.
fn others(package: &Package) -> impl Iterator<Item = &String> {
    let limits = facts().structure.others.iter().filter(|(folder, _)| within(&package.folder, folder));
    let limit = limits.max_by_key(|(folder, _)| folder.len()).map(|(_, names)| names);
    package.others.iter().filter(move |name| limit.is_some_and(|names| !names.contains(name)))
}
