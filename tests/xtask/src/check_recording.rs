//! `cargo xtask check-recording`: our recordings, read by readers that others wrote.
//!
//! They come from the Python registry into a virtual environment under `target/`. Where there is no Python or no registry
//! the check is skipped, and says so: our own readers are tested everywhere.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};
use clap::Args;

use crate::{program, shell};

/// What to read.
#[derive(Args)]
pub struct Options {
    /// The recording; without it, a run of the simulator is recorded.
    file: Option<PathBuf>,
    /// Places at which the file is cut.
    #[arg(long, default_value_t = 100)]
    cuts: u32,
}

/// Records, installs and reads. True when every reader agrees, or none can be had.
pub fn run(options: &Options) -> Result<bool> {
    if let Some(file) = options.file.as_ref().filter(|file| !file.is_file()) {
        bail!("{}: no such file; `floorguard simulate --record` makes one", file.display());
    }
    let work = shell::target_folder().join("check-recording");
    std::fs::create_dir_all(&work)?;
    let python = match environment(&work) {
        Ok(python) => python,
        Err(why) => {
            println!("check-recording: skipped: {why}");
            return Ok(true);
        }
    };
    let file = match &options.file {
        Some(file) => file.clone(),
        None => match record(&work)? {
            Some(file) => file,
            None => return Ok(false),
        },
    };
    println!("check-recording: {}", file.display());
    let mut check = Command::new(python);
    check.arg(readers().join("check.py")).arg(&file).args(["--cuts", &options.cuts.to_string()]);
    shell::succeeds(&mut check)
}

fn readers() -> PathBuf {
    shell::root().join("tests/readers")
}

/// A virtual environment with the readers; Rerun only where there is a wheel of it.
fn environment(work: &Path) -> Result<PathBuf, String> {
    let (venv, python) = (work.join("venv"), work.join("venv/bin/python"));
    if !python.is_file() {
        let made = shell::output(Command::new("python3").args(["-m", "venv"]).arg(&venv));
        made.ok_or("python3 makes no virtual environment here (install python3-venv)")?;
    }
    let install = |list: &str| {
        let mut pip = Command::new(&python);
        pip.args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--only-binary",
            ":all:",
        ]);
        shell::output(pip.arg("--requirement").arg(readers().join(list))).is_some()
    };
    if !install("requirements.txt") {
        return Err("pip cannot install the readers here (no registry?)".to_owned());
    }
    if !install("optional.txt") {
        println!("check-recording: skipped: pip cannot install Rerun here");
    }
    Ok(python)
}

/// A crossing with people, and an emergency stop.
fn record(work: &Path) -> Result<Option<PathBuf>> {
    let file = work.join("crossing.mcap");
    let mut simulate = program::command("floorguard")?;
    simulate.args(["simulate", "--json"]);
    simulate.args(["--scenario", "crossing", "--seed", "3", "--duration", "12", "--emergency-stop", "6..7"]);
    simulate.arg("--record").arg(&file);
    let done = shell::output(&mut simulate).is_some();
    if !done {
        eprintln!("check-recording: the run to be recorded failed; repeat it with: {simulate:?}");
    }
    Ok(done.then_some(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_file_is_named_before_installation() {
        let wrong = Options { file: Some(PathBuf::from("/nowhere/run.mcap")), cuts: 1 };
        let error = run(&wrong).unwrap_err().to_string();
        assert!(error.contains("/nowhere/run.mcap: no such file"), "{error}");
    }
}
