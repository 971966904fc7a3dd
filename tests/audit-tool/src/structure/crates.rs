//! The packages of the workspace as Cargo knows them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};
use serde_json::Value;

use super::graph::Graph;
use crate::shell;

/// A package.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Package {
    pub name: String,
    /// From the root of the workspace.
    pub folder: String,
    /// Packages of the workspace that it is built with; what only its tests need is left out.
    pub own: BTreeSet<String>,
    /// Packages of others that it is built with.
    pub others: BTreeSet<String>,
}

/// Asks Cargo.
pub fn read(root: &Path) -> Result<Vec<Package>> {
    let mut command = shell::cargo();
    command.args(["metadata", "--format-version", "1", "--no-deps", "--offline"]);
    let text = shell::output(&mut command).context("cargo metadata fails")?;
    let metadata: Value = serde_json::from_str(&text).context("cargo metadata prints another form")?;
    Ok(packages_in(&metadata, root))
}

fn packages_in(metadata: &Value, root: &Path) -> Vec<Package> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages = list(&metadata["packages"]);
    let names: BTreeSet<String> = packages.iter().map(|package| text(&package["name"])).collect();
    let package = |package: &Value| {
        let manifest = text(&package["manifest_path"]);
        let folder = Path::new(&manifest).parent().unwrap_or(root);
        let folder = folder.strip_prefix(root).unwrap_or(folder).to_string_lossy().replace('\\', "/");
        let needed = list(&package["dependencies"]).into_iter().filter(|one| one["kind"] != "dev");
        let (own, others) = needed.map(|one| text(&one["name"])).partition(|name| names.contains(name));
        Package { name: text(&package["name"]), folder, own, others }
    };
    packages.iter().map(package).collect()
}

/// The graph of their folders.
pub fn graph(packages: &[Package]) -> Graph {
    let folders: BTreeMap<&str, &str> =
        packages.iter().map(|package| (package.name.as_str(), package.folder.as_str())).collect();
    let mut graph = Graph::default();
    for package in packages {
        graph.add(&package.folder);
        let known = package.own.iter().filter_map(|name| folders.get(name.as_str()));
        known.for_each(|folder| graph.point(&package.folder, folder));
    }
    graph
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_build_dependencies_are_read() {
        let one = |name: &str, kind: Value| json!({ "name": name, "kind": kind });
        let package = |name: &str, needs: Vec<Value>| json!({ "name": name, "manifest_path": format!("/w/{name}/Cargo.toml"), "dependencies": needs });
        let needs = vec![one("b", Value::Null), one("libm", Value::Null), one("c", json!("dev"))];
        let metadata = json!({ "packages": [package("a", needs), package("b", vec![]), package("c", vec![one("a", json!("build"))])] });
        let packages = packages_in(&metadata, Path::new("/w"));
        assert_eq!(packages[0].folder, "a");
        assert_eq!(packages[0].own.iter().collect::<Vec<_>>(), ["b"]);
        assert_eq!(packages[0].others.iter().collect::<Vec<_>>(), ["libm"]);
        assert_eq!(graph(&packages).of("c").collect::<Vec<_>>(), ["a"]);
    }
}
