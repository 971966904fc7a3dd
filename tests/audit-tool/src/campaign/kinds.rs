//! The campaigns that there are. Each is a test, whose short slice CI runs too.

use crate::facts::{Kind, facts};

/// Whether there is such a campaign; if not, which ones there are.
pub fn exists(name: &str) -> Result<(), String> {
    if others().any(|other| other == name) { Ok(()) } else { find(name).map(|_| ()) }
}

/// Campaigns that do not count trials of one kind.
fn others() -> impl Iterator<Item = &'static str> {
    let mutants = facts().mutants.iter().map(|part| part.name.as_str());
    ["loops"].into_iter().chain(mutants).chain(facts().other_campaigns.iter().map(String::as_str))
}

/// By its name, or the names that there are.
pub fn find(name: &str) -> Result<&'static Kind, String> {
    let kinds = &facts().campaign;
    let names = || {
        let kinds = kinds.iter().map(|kind| kind.name.as_str());
        kinds.chain(others()).collect::<Vec<_>>().join(", ")
    };
    kinds
        .iter()
        .find(|kind| kind.name == name)
        .ok_or_else(|| format!("no campaign `{name}`; there are: {}", names()))
}

#[cfg(test)]
mod tests {
    use crate::facts::facts;

    /// What is fuzzed in-process is fuzzed by libFuzzer, too, and is in the book.
    #[test]
    fn every_fuzzing_campaign_has_a_target_of_libfuzzer() {
        let root = crate::shell::root();
        let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap_or_default();
        let (manifest, book) = (read("fuzz/Cargo.toml"), read("docs/src/fuzzing.md"));
        for name in facts().campaign.iter().filter_map(|kind| kind.name.strip_prefix("fuzz-")) {
            let file = format!("fuzz_targets/{name}.rs");
            assert!(manifest.contains(&format!("path = \"{file}\"")), "{name} is not in fuzz/Cargo.toml");
            assert!(read(&format!("fuzz/{file}")).contains("fuzz_target!"), "{file} is no target");
            assert!(book.contains(&format!("| `{name}` |")), "{name} is not in the book");
        }
    }
}
