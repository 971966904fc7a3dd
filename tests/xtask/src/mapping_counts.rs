//! `cargo xtask mapping-counts`: what mapping costs on the emulated Cortex-M7, in instructions. No board of ours maps yet.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, bail};

use crate::machine::TARGET;
use crate::{setup, shell};

/// The image.
const PACKAGE: &str = "floorguard-mapping-image";
/// A place that is farther off than this, millimetres, and the counts are those of a mapping that is lost.
const OFF_MAX_MM: u64 = 150;
/// What a figure is meant to be at most, by its name.
const AIMS: [(&str, u64); 2] = [("lidar-odometry-sweep", 6_000_000), ("graph-mapping", 200_000)];

/// Builds and runs the image. True if its places are right.
///
/// # Errors
/// A tool is missing, or the image does not build or run.
pub fn run() -> Result<bool> {
    setup::need_target()?;
    setup::need_emulator()?;
    let mut emulator = Command::new("qemu-system-arm");
    emulator.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none", "-serial", "null"]);
    emulator.args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"]);
    let output = emulator.arg("-kernel").arg(built()?).stdin(Stdio::null()).output();
    let output = output.context("qemu-system-arm does not start")?;
    // Semihosting writes to standard error.
    let text =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        bail!("the image failed: {}", text.trim());
    }
    let lines: Vec<String> = text.lines().filter_map(line).collect();
    lines.iter().for_each(|line| println!("{line}"));
    let places = offsets(&text);
    Ok(places.len() == 2 && places.iter().all(|off_mm| *off_mm <= OFF_MAX_MM))
}

fn built() -> Result<PathBuf> {
    let mut build = shell::cargo();
    build.args(["build", "--quiet", "--package", PACKAGE, "--profile", "firmware", "--target", TARGET]);
    if !shell::succeeds(&mut build)? {
        bail!("the image does not build; repeat it with: {build:?}");
    }
    Ok(shell::target_folder().join(TARGET).join("firmware").join(PACKAGE))
}

/// A line of the image in words; `None`: it says nothing to people.
fn line(text: &str) -> Option<String> {
    let aim = |name: &str| {
        let aim = AIMS.iter().find(|(known, _)| *known == name);
        aim.map_or_else(String::new, |(_, aim)| format!(" (aim {aim})"))
    };
    match text.split_whitespace().collect::<Vec<_>>().as_slice() {
        ["instructions", name, "count", count, "mean", mean, "max", max] => Some(format!(
            "  {name:26} {count:>5} times, {mean:>11} instructions on the mean, {max:>11} at most{}",
            aim(name)
        )),
        ["bytes", name, bytes] => Some(format!("  {name:26} {bytes} bytes{}", aim(name))),
        ["off_mm", name, off] => Some(format!("  {name:26} at most {off} mm off its true place")),
        _ => None,
    }
}

/// How far off the places are.
fn offsets(text: &str) -> Vec<u64> {
    let words = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    words
        .filter_map(|words| match words.as_slice() {
            ["off_mm", _, off] => off.parse().ok(),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_image_become_words() {
        let row = line("instructions lidar-odometry-sweep count 23 mean 6788252 max 9940024").unwrap();
        assert!(row.contains("23 times") && row.ends_with("9940024 at most (aim 6000000)"), "{row}");
        assert!(line("bytes lidar-odometry 920688").is_some_and(|row| row.ends_with("920688 bytes")));
        assert_eq!(line("a bell"), None);
        assert_eq!(offsets("off_mm a 15\nx\noff_mm b 91"), [15, 91]);
    }
}
