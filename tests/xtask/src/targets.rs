//! `cargo xtask targets`: the crates of the core and the drivers, built for every kind of processor that they are meant for.

use std::time::Instant;

use anyhow::Result;
use clap::Args;

use crate::{machine, shell};
use embedded_audit::sources;

/// Which crates.
#[derive(Args)]
pub struct Options {
    /// Build only the crates whose name contains this word.
    #[arg(long, default_value = "")]
    only: String,
}

impl Options {
    fn packages(&self) -> Vec<&'static str> {
        let all = sources::crates().iter().map(|one| one.package.as_str());
        all.filter(|package| package.contains(&self.only)).collect()
    }
}

/// Name for rustc and cargo, and an example of what has it.
type Target = (&'static str, &'static str);

/// What the crates are meant for, besides the host.
const TARGETS: [Target; 5] = [
    ("thumbv7em-none-eabihf", "Cortex-M4F and M7"),
    ("thumbv6m-none-eabi", "Cortex-M0 and M0+: no hardware floats, no compare-and-swap"),
    ("riscv32imac-unknown-none-elf", "RISC-V microcontrollers"),
    ("aarch64-unknown-none", "64-bit ARM without an operating system"),
    ("wasm32-unknown-unknown", "browsers"),
];

/// How the crates are compiled: in full without features, and as far as errors go with the feature that all have.
const WAYS: [(&str, &str); 2] = [("build", ""), ("check", "defmt")];

/// What came of one target.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Built,
    Failed,
    Skipped,
}

/// Builds for the host and each target and packs the crates. A target that cannot be installed is skipped and named. Good if
/// nothing failed.
pub fn run(options: &Options) -> Result<bool> {
    let packages = options.packages();
    let mut outcomes = vec![("the host", build(&packages, None)?)];
    for (target, example) in TARGETS {
        println!("\n== {target}: {example}");
        let is_there = machine::has_target(target) || machine::add_target(target)?;
        outcomes.push((target, if is_there { build(&packages, Some(target))? } else { Outcome::Skipped }));
    }
    println!("\n== packages: what others would download");
    outcomes.push(("packages", package()?));
    println!();
    for (target, outcome) in &outcomes {
        println!("{target}: {}", words(*outcome));
    }
    Ok(outcomes.iter().all(|(_, outcome)| *outcome != Outcome::Failed))
}

/// Compiles the crates in one go, in each way.
fn build(packages: &[&str], target: Option<&str>) -> Result<Outcome> {
    for (verb, feature) in WAYS {
        let start = Instant::now();
        let arguments = arguments(packages, target, (verb, feature));
        if !shell::succeeds(shell::cargo().args(&arguments))? {
            return Ok(Outcome::Failed);
        }
        let named = if feature.is_empty() { "no features" } else { feature };
        println!("{verb} of {} crates, {named}: {:.0} s", packages.len(), start.elapsed().as_secs_f64());
    }
    Ok(Outcome::Built)
}

/// Packs all crates in one go, because none of them is known to a registry: each finds the others among those just packed.
fn package() -> Result<Outcome> {
    let packages = sources::crates().iter().flat_map(|one| ["--package", one.package.as_str()]);
    let mut cargo = shell::cargo();
    cargo.args(["package", "--quiet", "--offline", "--no-verify", "--allow-dirty"]).args(packages);
    Ok(if shell::succeeds(&mut cargo)? { Outcome::Built } else { Outcome::Failed })
}

/// What cargo is called with.
fn arguments(packages: &[&str], target: Option<&str>, (verb, feature): (&str, &str)) -> Vec<String> {
    let mut arguments: Vec<String> = [verb, "--quiet", "--lib"].map(String::from).to_vec();
    for package in packages {
        arguments.extend(["--package", package].map(String::from));
        if !feature.is_empty() {
            arguments.extend(["--features".to_owned(), format!("{package}/{feature}")]);
        }
    }
    arguments.extend(target.into_iter().flat_map(|target| ["--target".to_owned(), target.to_owned()]));
    arguments
}

fn words(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Built => "built",
        Outcome::Failed => "FAILED",
        Outcome::Skipped => "skipped, its standard library is missing and rustup could not add it",
    }
}

#[cfg(test)]
mod tests {
    use super::{Options, arguments};

    #[test]
    fn every_audited_crate_is_built_with_its_feature() {
        let packages = Options { only: String::new() }.packages();
        let arguments = arguments(&packages, Some("thumbv6m-none-eabi"), ("check", "defmt")).join(" ");
        for package in ["types", "guard", "perception", "drivers"] {
            let wanted = format!("--package floorguard-{package} --features floorguard-{package}/defmt");
            assert!(arguments.contains(&wanted), "{wanted}: {arguments}");
        }
        assert!(arguments.ends_with("--target thumbv6m-none-eabi"));
    }
}
