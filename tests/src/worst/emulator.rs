//! Plays tapes on the emulated board and reads its counts.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

/// The board's PSRAM.
const TAPE_AT: u32 = 0x6000_0000;

/// The firmware that plays tapes, and where tapes are put.
#[derive(Clone, Debug)]
pub struct Emulator {
    /// The linked image.
    pub image: PathBuf,
    /// Place of the tape.
    pub tape: PathBuf,
}

impl Emulator {
    /// Most instructions of each stage.
    ///
    /// # Errors
    /// The emulator is missing, or the firmware fails: a worst input may be costly and must not be deadly.
    pub fn largest(&self, tape: &[u8]) -> Result<BTreeMap<String, u64>> {
        Ok(counts_in(&self.play(tape)?))
    }

    /// Fingerprint of all outputs.
    ///
    /// # Errors
    /// The emulator is missing, the firmware fails, or it tells no fingerprint.
    pub fn digest(&self, tape: &[u8]) -> Result<String> {
        let text = self.play(tape)?;
        let reported = text.lines().find_map(|line| line.strip_prefix("digest "));
        reported.map(|digest| digest.trim().to_owned()).context("the firmware tells no fingerprint")
    }

    fn play(&self, tape: &[u8]) -> Result<String> {
        std::fs::write(&self.tape, tape)?;
        let mut emulator = Command::new("qemu-system-arm");
        emulator.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none", "-serial", "null"]);
        emulator.args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"]);
        let loader = format!("loader,file={},addr={TAPE_AT:#x},force-raw=on", self.tape.display());
        emulator.args(["-device", &loader, "-kernel"]).arg(&self.image);
        let output = emulator.stdin(Stdio::null()).output().context("cannot start qemu-system-arm")?;
        let text =
            String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            bail!("the firmware failed: {}", text.trim());
        }
        Ok(text)
    }
}

fn counts_in(text: &str) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for line in text.lines() {
        if let ["instructions", name, "count", _, "mean", _, "max", max] =
            line.split_whitespace().collect::<Vec<_>>().as_slice()
        {
            counts.insert((*name).to_owned(), max.parse().unwrap_or(0));
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::counts_in;

    #[test]
    fn counts_are_read() {
        let text = "digest 12\ninstructions sweep count 3 mean 10 max 17\n";
        assert_eq!(counts_in(text).get("sweep"), Some(&17));
    }
}
