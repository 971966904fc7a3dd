//! `cargo xtask same-bits`: the program for another processor, its instructions emulated, beside this computer's: a simulated run of the
//! whole robot and a published log that is mapped come out the same to the bit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use serde_json::Value;

use crate::{machine, package, program, shell};

/// Files of a map whose bits must be the same; the others name times that were needed.
const MAP_FILES: [&str; 4] = ["map.pgm", "map.yaml", "trajectory.tum", "graph.g2o"];
/// The log that is mapped, where it is.
const LOG: &str = "../shared/data/slam2d_logs/radish_aces.clf.bz2";

/// What to play.
#[derive(Args)]
pub struct Options {
    /// Scenario of the simulated run.
    #[arg(long, default_value = "supermarket")]
    scenario: String,
    /// Its length, simulated seconds: the emulator takes two or three for each.
    #[arg(long, default_value_t = 20)]
    duration: u32,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// A program and what runs it.
struct Runner {
    emulator: Option<&'static str>,
    program: PathBuf,
}

impl Runner {
    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = match self.emulator {
            Some(emulator) => {
                let mut command = Command::new(emulator);
                command.args(["-L", "/usr/aarch64-linux-gnu"]).arg(&self.program);
                command
            }
            None => Command::new(&self.program),
        };
        command.args(arguments);
        command
    }

    /// The summary of a simulated run.
    fn simulated(&self, options: &Options) -> Result<Value> {
        let [duration, seed] = [options.duration.to_string(), options.seed.to_string()];
        let run =
            ["simulate", "--scenario", &options.scenario, "--seed", &seed, "--duration", &duration, "--json"];
        let text = shell::output(&mut self.command(&run))
            .with_context(|| format!("{} does not simulate {}", self.program.display(), options.scenario))?;
        serde_json::from_str(&text).context("the summary of the run is no JSON")
    }
}

/// Builds both programs and plays. True if all bits agree.
///
/// # Errors
/// A compiler, linker or emulator is missing, which is named, or a program does not run.
pub fn run(options: &Options) -> Result<bool> {
    let Some(emulator) = machine::user_emulator() else {
        bail!("qemu-aarch64 is missing; please run as root: apt-get install qemu-user-static");
    };
    let there = Runner { emulator: Some(emulator), program: package::program_for("arm64")? };
    let here = Runner { emulator: None, program: program::built("floorguard")? };
    let [ours, theirs] = [here.simulated(options)?, there.simulated(options)?];
    let is_same = ours == theirs;
    let digest = |summary: &Value| summary["digest"].as_str().unwrap_or("none").to_owned();
    println!(
        "{}, seed {}, {} s: digest {} here, {} on arm64: {}",
        options.scenario,
        options.seed,
        options.duration,
        digest(&ours),
        digest(&theirs),
        word(is_same)
    );
    let log = shell::root().join(LOG);
    if !log.exists() {
        println!("skipped: no log to map at {LOG}");
        return Ok(is_same);
    }
    Ok(maps_agree(&log, [&here, &there])? && is_same)
}

fn maps_agree(log: &Path, runners: [&Runner; 2]) -> Result<bool> {
    let work = shell::target_folder().join("same-bits");
    fs::create_dir_all(&work)?;
    let mut maps = Vec::new();
    for (runner, name) in runners.into_iter().zip(["here", "arm64"]) {
        let out = work.join(name);
        let arguments = ["map", &log.display().to_string(), "--out", &out.display().to_string()];
        let output = runner.command(&arguments).output().context("the program does not start")?;
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        maps.push(out);
    }
    let mut all = true;
    for name in MAP_FILES {
        let bytes = |folder: &PathBuf| fs::read(folder.join(name)).with_context(|| name.to_owned());
        let is_same = bytes(&maps[0])? == bytes(&maps[1])?;
        println!("{name} of {LOG}: {}", word(is_same));
        all &= is_same;
    }
    Ok(all)
}

const fn word(is_same: bool) -> &'static str {
    if is_same { "the same" } else { "DIFFERENT" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_programs_run_under_the_emulator() {
        let runner = |emulator| Runner { emulator, program: PathBuf::from("floorguard") };
        let words = |runner: &Runner| {
            let command = runner.command(&["check"]);
            let all = std::iter::once(command.get_program()).chain(command.get_args());
            all.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(words(&runner(None)), "floorguard check");
        assert_eq!(
            words(&runner(Some("qemu-aarch64-static"))),
            "qemu-aarch64-static -L /usr/aarch64-linux-gnu floorguard check"
        );
    }
}
