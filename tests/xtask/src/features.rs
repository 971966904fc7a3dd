//! Programs that steps of the test command build alone take the features with which the tests were built. Otherwise the
//! dependency whose features differ, and all that stands on it, is compiled twice.

use std::collections::BTreeSet;

use crate::shell;

/// Differences that cost little: only the programs of the tests stand on them.
const ALLOWED: [&str; 1] = ["getrandom"];

/// `name version [features]` of all dependencies of a selection of packages.
fn features(edges: &str, selection: &[&str]) -> BTreeSet<String> {
    let mut tree = shell::cargo();
    tree.args(["tree", "--offline", "--prefix", "none", "--edges", edges, "--format", "{p} [{f}]"]);
    let printed = shell::output(tree.args(selection)).expect("cargo tree");
    printed.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

#[test]
fn programs_share_the_features_of_tests() {
    let built = features("normal,build,dev", &["--workspace"]);
    for package in ["floorguard", "floorguard-tests"] {
        let alone = features("normal,build", &["--package", package]);
        assert!(alone.len() > 100, "{package}: {} dependencies", alone.len());
        let twice: Vec<_> = alone
            .difference(&built)
            .filter(|line| !ALLOWED.iter().any(|name| line.starts_with(&format!("{name} v"))))
            .collect();
        assert!(twice.is_empty(), "{package}: compiled twice; give them one set of features: {twice:#?}");
    }
}
