//! What a campaign runs: its own copy of the test and of the firmware, and the fingerprint of the code they were built from.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::block::{self, Program};
use super::record;
use crate::facts::{Kind, facts};
use crate::shell;

/// What the campaign runs, beside its state: kept from its beginning if the `same` is wanted, otherwise built now.
pub fn programs(kind: &Kind, state: &Path, same: bool) -> Result<Program> {
    let has_firmware = kind.firmware;
    let kept = Program {
        test: state.with_extension("program"),
        firmware: has_firmware.then(|| state.with_extension("firmware")),
    };
    if !same || !is_kept(&kept)? {
        make(&kept, &state.with_extension("code"), &|| record::code_of(kind), || {
            let test = block::build(kind)?;
            Ok(Program { test, firmware: has_firmware.then(build_firmware).transpose()? })
        })?;
    }
    Ok(kept)
}

/// Builds the image that the campaign plays on.
fn build_firmware() -> Result<PathBuf> {
    let firmware = facts().firmware.as_ref().context("the facts name no firmware")?;
    let mut build = shell::cargo();
    build.args(["build", "--quiet", "--package", &firmware.package, "--bin", &firmware.binary]);
    build.args(["--profile", &firmware.profile, "--target", &firmware.target]);
    if !shell::succeeds(&mut build)? {
        bail!("the firmware does not build");
    }
    Ok(shell::target_folder().join(&firmware.target).join(&firmware.profile).join(&firmware.binary))
}

/// The code that the kept program was built from, if that is known.
pub fn code(state: &Path) -> Option<String> {
    std::fs::read_to_string(state.with_extension("code")).ok()
}

/// The campaign has begun. A test without the firmware that it began with is refused: beside today's it would be another one.
fn is_kept(kept: &Program) -> Result<bool> {
    let firmware = kept.firmware.as_deref().filter(|firmware| !firmware.is_file());
    match firmware {
        _ if !kept.test.is_file() => Ok(false),
        None => Ok(true),
        Some(firmware) => bail!(
            "{} is there, but not the firmware that it began with, {}; leave --same-program out to build both and begin anew",
            kept.test.display(),
            firmware.display()
        ),
    }
}

/// Builds and copies: a build that goes on beside the campaign must not change what its blocks run.
fn make(
    kept: &Program,
    code: &Path,
    code_now: &dyn Fn() -> Result<String>,
    build: impl FnOnce() -> Result<Program>,
) -> Result<()> {
    let before = code_now()?;
    let built = build()?;
    if code_now()? != before {
        bail!(
            "the sources changed while the campaign's program was built, so that nobody knows what is in it; start it again"
        );
    }
    // In this order: wherever it is cut, no program stands beside the firmware or the fingerprint of another one.
    for old in [Some(code), kept.firmware.as_deref()].into_iter().flatten() {
        remove(old)?;
    }
    copy(&built.test, &kept.test)?;
    if let (Some(from), Some(to)) = (&built.firmware, &kept.firmware) {
        copy(from, to)?;
    }
    std::fs::write(code, before).with_context(|| format!("cannot write {}", code.display()))
}

fn remove(file: &Path) -> Result<()> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", file.display()))
        }
        _ => Ok(()),
    }
}

/// The whole file, or none.
fn copy(from: &Path, to: &Path) -> Result<()> {
    let beside: PathBuf = to.with_extension("building");
    std::fs::copy(from, &beside)
        .and_then(|_| std::fs::rename(&beside, to))
        .with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A campaign on the firmware in a folder of its own.
    struct Begun {
        folder: tempfile::TempDir,
        kept: Program,
        code: PathBuf,
    }

    impl Begun {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let place = |name: &str| folder.path().join(name);
            let kept = Program { test: place("a.program"), firmware: Some(place("a.firmware")) };
            Self { kept, code: place("a.code"), folder }
        }

        /// Builds test and firmware of this text from sources of the same; `edited` meanwhile or not.
        fn make(&self, text: &str, edited: bool) -> Result<()> {
            let sources = Cell::new(false);
            let code_now = || Ok(format!("{text}{}", if sources.get() { " edited" } else { "" }));
            make(&self.kept, &self.code, &code_now, || {
                sources.set(edited);
                let built = |name: &str| {
                    let path = self.folder.path().join(name);
                    std::fs::write(&path, text).map(|()| path)
                };
                Ok(Program { test: built("test")?, firmware: Some(built("image")?) })
            })
        }

        /// Test, firmware and code.
        fn kept(&self) -> Vec<Option<String>> {
            let all = [&self.kept.test, self.kept.firmware.as_ref().unwrap(), &self.code];
            all.into_iter().map(|file| std::fs::read_to_string(file).ok()).collect()
        }
    }

    fn three(text: &str) -> Vec<Option<String>> {
        vec![Some(text.to_owned()); 3]
    }

    #[test]
    fn campaign_keeps_its_program_until_replaced() {
        let begun = Begun::new();
        assert!(!is_kept(&begun.kept).unwrap());
        begun.make("first", false).unwrap();
        assert_eq!(begun.kept(), three("first"));
        assert!(is_kept(&begun.kept).unwrap());
        let broken =
            make(&begun.kept, &begun.code, &|| Ok(String::from("second")), || bail!("it does not build"));
        assert!(broken.is_err());
        assert_eq!(begun.kept(), three("first"), "the fingerprint of what was not built");
        begun.make("third", false).unwrap();
        assert_eq!(begun.kept(), three("third"));
    }

    #[test]
    fn source_changes_during_the_build_are_reported() {
        let begun = Begun::new();
        begun.make("first", false).unwrap();
        let reported = begun.make("second", true).unwrap_err().to_string();
        assert!(reported.contains("the sources changed"), "{reported}");
        assert_eq!(begun.kept(), three("first"));
    }

    #[test]
    fn test_without_its_firmware_fails() {
        let begun = Begun::new();
        begun.make("first", false).unwrap();
        std::fs::remove_file(begun.kept.firmware.as_ref().unwrap()).unwrap();
        let reported = is_kept(&begun.kept).unwrap_err().to_string();
        assert!(reported.contains("a.firmware") && reported.contains("--same-program"), "{reported}");
    }

    #[test]
    fn uncopyable_file_is_named_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let reported =
            copy(&folder.path().join("absent"), &folder.path().join("to")).unwrap_err().to_string();
        assert!(reported.contains("absent to ") && reported.ends_with("/to"), "{reported}");
    }
}
