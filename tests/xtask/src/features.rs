//! Programs that steps of the test command build alone take the features with which the tests were built. Otherwise the
//! dependency whose features differ, and all that stands on it, is compiled twice.

use std::collections::BTreeSet;

use crate::shell;

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
    // As `program::built` selects them.
    let programs = features("normal,build", &["--workspace"]);
    assert!(programs.len() > 100, "{} dependencies", programs.len());
    let twice: Vec<_> = programs.difference(&built).collect();
    assert!(twice.is_empty(), "compiled twice; give them one set of features: {twice:#?}");
}
