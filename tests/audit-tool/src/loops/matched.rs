//! Which record is of which loop: by its whole name, and where code moved within its crate, by what is left of the name.

use std::collections::BTreeMap;

use super::LoopSite;
use super::record::{Name, Record, numbers};

/// The folder of the crate that a file belongs to.
fn crate_of(file: &str) -> &str {
    file.split("/src/").next().unwrap_or(file)
}

/// What a loop keeps when its function moves to another file of its crate.
fn moved((file, function, kind, number, bound): &Name) -> Name {
    (crate_of(file).to_owned(), function.clone(), kind.clone(), *number, bound.clone())
}

/// What a loop keeps when a loop before it in its function comes or goes.
fn renumbered((file, function, kind, _, bound): &Name) -> Name {
    (file.clone(), function.clone(), kind.clone(), 0, bound.clone())
}

/// The record of each loop that has one, in the order of the loops, and how many records are of none.
pub fn matched(records: Vec<Record>, sites: &[LoopSite]) -> (Vec<Option<Record>>, usize) {
    let mut left: BTreeMap<Name, Record> =
        records.into_iter().map(|record| (record.name(), record)).collect();
    let names: Vec<Name> = sites
        .iter()
        .zip(numbers(sites))
        .map(|(site, number)| {
            (site.file.clone(), site.function.clone(), site.kind.clone(), number, site.bound.clone())
        })
        .collect();
    let mut found: Vec<Option<Record>> = names.iter().map(|name| left.remove(name)).collect();
    for key in [moved, renumbered] {
        let open: Vec<usize> = (0..names.len())
            .filter(|index| found[*index].is_none() && !sites[*index].edits.is_empty())
            .collect();
        let records = alone(left.keys().map(|name| (key(name), name.clone())));
        let loops = alone(open.into_iter().map(|index| (key(&names[index]), index)));
        for (name, index) in loops {
            if let Some(record) = records.get(&name) {
                found[index] = left.remove(record);
            }
        }
    }
    (found, left.len())
}

/// What has a key of its own: two of one key may be either of two.
fn alone<T>(keyed: impl Iterator<Item = (Name, T)>) -> BTreeMap<Name, T> {
    let mut all = BTreeMap::<Name, Vec<T>>::new();
    for (key, one) in keyed {
        all.entry(key).or_default().push(one);
    }
    let single =
        |(key, mut some): (Name, Vec<T>)| some.pop().filter(|_| some.is_empty()).map(|one| (key, one));
    all.into_iter().filter_map(single).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{loops, sources};

    fn sites(file: &str, text: &str) -> Vec<LoopSite> {
        loops::list(&sources::parse(file, text.to_owned()).expect("it parses")).0
    }

    fn record(file: &str, number: usize, bound: &str) -> Record {
        let text = str::to_owned;
        Record {
            file: text(file),
            function: text("f"),
            kind: text("for"),
            number,
            bound: text(bound),
            largest: Some(3),
            bound_value: 0,
        }
    }

    #[test]
    fn moved_and_renumbered_loops_keep_their_records() {
        let sites = sites("core-nostd/guard/src/new.rs", "fn f() { for i in 0..7 {} for i in 0..4 {} }");
        let elsewhere = record("core-nostd/guard/src/old.rs", 0, "7");
        let before = record("core-nostd/guard/src/new.rs", 0, "4");
        let (found, gone) = matched(vec![elsewhere.clone(), before.clone()], &sites);
        assert_eq!((found, gone), (vec![Some(elsewhere), Some(before)], 0));
    }

    #[test]
    fn other_crates_and_doubtful_records_match_nothing() {
        let sites = sites("core-nostd/guard/src/new.rs", "fn f() { for i in 0..4 {} }");
        let (found, gone) = matched(vec![record("core-nostd/mapping/src/new.rs", 0, "4")], &sites);
        assert_eq!((found, gone), (vec![None], 1));
        let two = ["a", "b"].map(|file| record(&format!("core-nostd/guard/src/{file}.rs"), 0, "4"));
        assert_eq!(matched(two.to_vec(), &sites), (vec![None], 2), "either may be it");
    }
}
