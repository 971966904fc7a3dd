//! Planted cycles, arrows and long files: each must be refused.

use std::collections::{BTreeMap, BTreeSet};

use super::allowed::{self, Forbidden};
use super::claims::{self, Found};
use super::crates::Package;
use super::known::Offenders;
use super::modules;
use super::sizes::Lines;
use crate::sources;
use crate::sources::SourceFile;

const TABLE: &str = "\
| package | folder | may depend on (of ours) |
|---|---|---|
| `floorguard-types` | `core-nostd/types` | nothing |
| `floorguard-guard` | `core-nostd/guard` | types |
| `floorguard-runtime` | `runtime` | core, drivers |
| `floorguard-board-support` | `runtime/boards` | runtime and below |
| `floorguard-sim` | `hal-sim` | types (values only, no guard) |
| app | `app/robot`, `app/panel` | everything above |
| tests | `tests` | everything |

| other | may depend on |
|---|---|
| `core-nostd/guard` | app |
";

fn package(folder: &str, own: &[&str], others: &[&str]) -> Package {
    let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    let name = match folder {
        "hal-sim" => "sim",
        "runtime/boards" => "board-support",
        folder => folder.rsplit('/').next().unwrap_or(folder),
    };
    let own = own.iter().map(|name| format!("floorguard-{name}")).collect();
    Package { name: format!("floorguard-{name}"), folder: folder.to_owned(), own, others: set(others) }
}

fn good() -> Vec<Package> {
    vec![
        package("core-nostd/types", &[], &["heapless"]),
        package("core-nostd/guard", &["types"], &["libm"]),
        package("runtime", &["guard", "types"], &["embassy-sync"]),
        package("runtime/boards", &["runtime", "guard"], &[]),
        package("hal-sim", &["types"], &[]),
        package("app/robot", &["guard", "panel", "sim"], &["tokio"]),
        package("app/panel", &[], &[]),
        package("tests", &["robot", "types"], &[]),
    ]
}

/// What is forbidden when one package knows something more.
fn planted(folder: &str, own: &[&str], others: &[&str]) -> Vec<(String, String)> {
    let mut packages = good();
    let changed = packages.iter_mut().find(|package| package.folder == folder).expect("a package");
    let more = package(folder, own, others);
    changed.own.extend(more.own);
    changed.others.extend(more.others);
    let found = allowed::forbidden(&packages, &allowed::rows_in(TABLE));
    found.into_iter().map(|Forbidden { from, to, .. }| (from, to)).collect()
}

#[test]
fn disallowed_arrow_is_refused() {
    let arrow = |from: &str, to: &str| [(from.to_owned(), to.to_owned())];
    assert_eq!(planted("tests", &["panel"], &["anything"]), []);
    assert_eq!(planted("runtime/boards", &["types"], &[]), [], "below the runtime");
    assert_eq!(planted("app/panel", &["robot"], &[]), [], "of the same row");
    assert_eq!(planted("core-nostd/guard", &["panel"], &[]), arrow("core-nostd/guard", "app/panel"));
    assert_eq!(planted("core-nostd/guard", &["runtime"], &[]), arrow("core-nostd/guard", "runtime"));
    assert_eq!(planted("core-nostd/guard", &[], &["tokio"]), arrow("core-nostd/guard", "tokio"));
    assert_eq!(planted("core-nostd/types", &["guard"], &[]), arrow("core-nostd/types", "core-nostd/guard"));
    assert_eq!(planted("hal-sim", &["guard"], &[]), arrow("hal-sim", "core-nostd/guard"), "in brackets");
    assert_eq!(planted("runtime", &["board-support"], &[]), arrow("runtime", "runtime/boards"));
    assert_eq!(planted("runtime/boards", &["sim"], &[]), arrow("runtime/boards", "hal-sim"));
    assert_eq!(planted("app/panel", &["tests"], &[]), arrow("app/panel", "tests"));
    let alone = [package("elsewhere", &[], &[])];
    let found = allowed::forbidden(&alone, &allowed::rows_in(TABLE));
    assert_eq!((found.len(), found[0].line), (1, 0), "no row speaks of it");
}

fn crate_of(files: &[(&str, &str)]) -> modules::Modules {
    let parse = |(name, text): &(&str, &str)| {
        sources::parse(&format!("a/src/{name}"), (*text).to_owned()).expect("it parses")
    };
    let files: Vec<SourceFile> = files.iter().map(parse).collect();
    modules::read("a_crate", "a/src", &files)
}

fn cycles(files: &[(&str, &str)]) -> usize {
    crate_of(files).graph.cycles().len()
}

#[test]
fn module_cycle_is_found_in_any_notation() {
    let root = ("lib.rs", "pub mod one; pub mod two; pub use one::Handed; pub use two::inner::*;");
    let one = ("one/mod.rs", "use crate::two::Item;\npub struct Handed;");
    assert_eq!(cycles(&[root, one, ("two/mod.rs", "pub mod inner; pub struct Item;")]), 0);
    for back in [
        "use crate::one::Handed;",
        "use crate::{one::Handed as H};",
        "use super::one::Handed;",
        "use crate::Handed;",
        "fn f() { crate::one::g() }",
        "fn f() -> crate::one::Handed { crate::one::Handed }",
        "fn f() { println!(\"{}\", crate::one::g()) }",
        "macro_rules! m { () => { crate::one::g() } }",
        "mod below { use super::super::one; }",
        "use a_crate::one::Handed;",
    ] {
        assert_eq!(cycles(&[root, one, ("two/mod.rs", back)]), 1, "{back}");
    }
    for no_arrow in [
        "use std::one::Handed;",
        "mod one { pub struct Handed; } use self::one::Handed;",
        "#[cfg(test)]\nmod tests { use crate::one::Handed; }",
        "// crate::one::Handed",
        "mod below { use super::one; } mod one {}",
    ] {
        assert_eq!(cycles(&[root, one, ("two/mod.rs", no_arrow)]), 0, "{no_arrow}");
    }
    let inner = ("two/inner.rs", "use super::super::one::Handed;\npub struct Deep;");
    assert_eq!(cycles(&[root, one, inner]), 1, "from a file below");
    let through_the_root = ("one/mod.rs", "use crate::Deep;");
    let back = ("two/mod.rs", "pub use inner::Deep; use crate::one;");
    let root = ("lib.rs", "pub mod one; pub mod two; pub use two::*;");
    assert_eq!(cycles(&[root, through_the_root, back]), 1, "the root hands it on from `two`");
}

fn found(packages: Vec<Package>, modules: modules::Modules, files: &[(&str, usize)]) -> Found {
    let files: Lines = files.iter().map(|(name, lines)| ((*name).to_owned(), *lines)).collect();
    let modules = BTreeMap::from([(String::from("app/panel"), modules)]);
    let mut found =
        Found { packages, modules, files, document: TABLE.to_owned(), known: Offenders::default() };
    let drawn = found.drawing();
    let markers = format!("{TABLE}<!-- drawn by cargo xtask structure --><!-- end of what is drawn -->\n");
    found.document = super::drawing::replaced(&markers, &drawn).expect("markers");
    found
}

fn failing(found: &Found) -> Vec<&'static str> {
    claims::claims(found).iter().filter(|claim| !claim.holds()).map(|claim| claim.id).collect()
}

#[test]
fn each_planted_fault_turns_its_claim() {
    let whole = || crate_of(&[("lib.rs", ""), ("one.rs", "use crate::two;"), ("two.rs", "")]);
    let circle = || crate_of(&[("lib.rs", ""), ("one.rs", "use crate::two;"), ("two.rs", "use crate::one;")]);
    let short = [("app/panel/src/one.rs", 12)];
    assert_eq!(failing(&found(good(), whole(), &short)), [""; 0]);
    let mut packages = good();
    packages[0].own.insert("floorguard-guard".to_owned());
    assert_eq!(failing(&found(packages, whole(), &short)), ["crates-layered"], "a cycle of crates");
    let mut packages = good();
    packages[1].own.insert("floorguard-panel".to_owned());
    assert_eq!(failing(&found(packages, whole(), &short)), ["crates-layered"], "an arrow");
    assert_eq!(failing(&found(good(), circle(), &short)), ["modules-acyclic"]);
    let long = [("app/panel/src/one.rs", 401), ("b.rs", 1), ("c.rs", 1)];
    assert_eq!(failing(&found(good(), whole(), &long)), ["files-short"]);
    let mut old = found(good(), whole(), &short);
    old.packages.push(package("app/panel/new", &[], &[]));
    assert_eq!(failing(&old), ["structure-drawn"]);
}

#[test]
fn known_cycles_are_listed_until_removed() {
    let circle = || crate_of(&[("lib.rs", ""), ("one.rs", "use crate::two;"), ("two.rs", "use crate::one;")]);
    let long = [("app/panel/src/one.rs", 500), ("b.rs", 1), ("c.rs", 1)];
    let mut borne = found(good(), circle(), &long);
    borne.known = borne.offenders();
    assert_eq!(failing(&borne), [""; 0]);
    borne.files.insert("app/panel/src/one.rs".to_owned(), 501);
    assert_eq!(failing(&borne), ["files-short"], "it grew");
    borne.files.insert("app/panel/src/one.rs".to_owned(), 499);
    assert_eq!(failing(&borne), ["files-short"], "the list can shrink");
    let mut better = found(good(), crate_of(&[("one.rs", "use crate::two;"), ("two.rs", "")]), &[]);
    better.known.cycles = circle_known();
    assert_eq!(failing(&better), ["modules-acyclic"], "the cycle is gone, the list still has it");
}

fn circle_known() -> BTreeMap<String, BTreeSet<String>> {
    BTreeMap::from([(String::from("app/panel"), BTreeSet::from(["one".to_owned(), "two".to_owned()]))])
}

/// The tree itself.
#[test]
fn the_tree_keeps_its_structure() {
    let claims = claims::judge(&crate::shell::root()).expect("the tree can be read");
    let findings = claims.iter().flat_map(|claim| &claim.findings).collect::<Vec<_>>();
    assert!(findings.is_empty(), "{findings:#?}");
}
