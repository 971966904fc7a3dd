//! What is latched, on disk: an emergency stop of the evening is still one in the morning (FG-REQ-070).

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use floorguard_guard::{CAUSES, Cause};
use floorguard_host::executor::StopFlag;
use floorguard_runtime::digest::Fnv64;
use floorguard_runtime::kept_latches::unknown_latches;

use super::rings::HostedShared;

/// How often the guard is examined: what is younger than this, and the time of the disk, is lost with the power.
const POLL_PERIOD: Duration = Duration::from_millis(20);
/// A disk that took nothing is tried again after so many looks.
const POLLS_PER_TRY: u32 = 50;
/// Causes of the first version that wrote the file.
const CAUSES_FIRST: usize = 42;
/// First words of the file.
const NAME: &str = "floorguard-latches 1";

/// The file, beside `robot.toml`.
#[derive(Clone, Debug)]
pub struct LatchFile {
    path: PathBuf,
}

impl LatchFile {
    /// For a robot's file: `robot.toml` has `robot.latched`.
    #[must_use]
    pub fn beside(robot_toml: &Path) -> Self {
        Self { path: robot_toml.with_extension("latched") }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What was latched when it was written last; nothing where there is no file. One that cannot be read, or that is not
    /// what was written, asks for the operator.
    #[must_use]
    pub fn read(&self) -> u64 {
        match std::fs::read_to_string(&self.path) {
            Ok(text) => parse(&text).unwrap_or_else(unknown_latches),
            Err(error) if error.kind() == ErrorKind::NotFound => 0,
            Err(_) => unknown_latches(),
        }
    }

    /// Writes beside it, and puts that in its place: a loss of power leaves one or the other.
    ///
    /// # Errors
    /// The disk takes nothing.
    pub fn write(&self, latches: u64) -> io::Result<()> {
        let new = self.path.with_extension("latched-new");
        let mut file = File::create(&new)?;
        file.write_all(text(latches).as_bytes())?;
        file.sync_all()?;
        std::fs::rename(&new, &self.path)?;
        // Not every file system takes it; the file itself is written.
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Writes what changes until the flag is set, and once more then. Runs on a thread of its own: a slow disk holds up no
    /// ring.
    pub(super) fn keep(&self, shared: &HostedShared, ended: &StopFlag) {
        let mut written = self.read();
        let (mut wait, mut refused) = (0_u32, false);
        loop {
            // Read before the guard is: what was latched before the end is still written.
            let last = ended.is_stopped();
            let latches = shared.latches.get().unwrap_or(written);
            wait = wait.saturating_sub(1);
            if latches != written && (wait == 0 || last) {
                match self.write(latches) {
                    Ok(()) => (written, refused) = (latches, false),
                    Err(error) => {
                        if !refused {
                            say!(
                                "  {}: cannot be written ({error}); what is latched is forgotten with the power",
                                self.path.display()
                            );
                        }
                        (wait, refused) = (POLLS_PER_TRY, true);
                    }
                }
            }
            if last {
                return;
            }
            thread::sleep(POLL_PERIOD);
        }
    }
}

/// The causes of some latches, in words.
#[must_use]
pub fn latched_words(latches: u64) -> String {
    let latched = Cause::all().into_iter().filter(|cause| latches & (1 << cause.index()) != 0);
    latched.map(Cause::name).collect::<Vec<_>>().join(", ")
}

/// With the number of causes: new ones get bits behind those of all others, so that what fewer causes wrote is still
/// understood, and what more causes wrote is not.
fn text(latches: u64) -> String {
    text_of(CAUSES, latches)
}

fn text_of(causes: usize, latches: u64) -> String {
    let words = format!("{NAME} {causes} {latches:016x}");
    let mut sum = Fnv64::new();
    sum.add(words.as_bytes());
    format!("{words} {:016x}\n", sum.value())
}

fn parse(written: &str) -> Option<u64> {
    let mut words = written.strip_prefix(NAME)?.split(' ').skip(1);
    let causes = words.next()?.parse().ok().filter(|causes| (CAUSES_FIRST..=CAUSES).contains(causes))?;
    let latches = u64::from_str_radix(words.next()?, 16).ok()?;
    (text_of(causes, latches) == written).then_some(latches)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fg_req_070_latch_round_trips_damage_needs_operator() {
        let folder = tempfile::tempdir().unwrap();
        let file = LatchFile::beside(&folder.path().join("robot.toml"));
        assert_eq!(file.read(), 0, "no file");
        for latches in [0, 1 << Cause::EmergencyStop.index(), u64::MAX >> 1] {
            file.write(latches).unwrap();
            assert_eq!(file.read(), latches);
        }
        let good = text(1 << Cause::BumperFront.index());
        for place in 0..good.len() {
            let mut bytes = good.clone().into_bytes();
            bytes[place] ^= 1;
            std::fs::write(file.path(), &bytes).unwrap();
            assert_eq!(file.read(), unknown_latches(), "byte {place}");
            std::fs::write(file.path(), &good.as_bytes()[..place]).unwrap();
            assert_eq!(file.read(), unknown_latches(), "cut at {place}");
        }
        for (causes, kept) in
            [(CAUSES_FIRST, 5), (CAUSES_FIRST - 1, unknown_latches()), (CAUSES + 1, unknown_latches())]
        {
            std::fs::write(file.path(), text_of(causes, 5)).unwrap();
            assert_eq!(file.read(), kept, "written by {causes} causes");
        }
        std::fs::write(file.path(), text(5).replace(&format!(" {CAUSES} "), &format!(" {CAUSES_FIRST} ")))
            .unwrap();
        assert_eq!(file.read(), unknown_latches(), "another number, the same sum");
        std::fs::remove_file(file.path()).unwrap();
        std::fs::create_dir(file.path()).unwrap();
        assert_eq!(file.read(), unknown_latches(), "cannot be read");
    }

    #[test]
    fn the_words_name_what_is_latched() {
        let both = 1 << Cause::EmergencyStop.index() | 1 << Cause::BumperRear.index();
        assert_eq!(latched_words(both), "emergency stop pressed, rear bumper pressed");
    }
}
