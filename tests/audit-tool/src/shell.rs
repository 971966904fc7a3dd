//! Starts other programs, with their output on the terminal and their failure in plain words.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use anyhow::{Context, Result, ensure};

/// Where the facts of a project are, from the root of its workspace.
pub const FILE: &str = "tests/audit.toml";

static ROOT: LazyLock<PathBuf> = LazyLock::new(|| {
    let here = std::env::current_dir().unwrap_or_default();
    let found = here.ancestors().find(|folder| folder.join(FILE).is_file());
    // Elsewhere, what this was built from.
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    found.or(built).unwrap_or(&here).to_path_buf()
});

/// The root of the workspace: the folder at or above the current one that has the facts.
pub fn root() -> PathBuf {
    ROOT.clone()
}

/// Where cargo puts what it builds.
pub fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The cargo that started us.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// Set where all tests of the workspace have just been built. Cargo builds a package alone with fewer features of its dependencies
/// than together with all others, so that nearly everything would be built once more for each program that is asked for alone.
pub const ALL_BUILT: &str = "XTASK_ALL_BUILT";

fn all_built() -> bool {
    std::env::var_os(ALL_BUILT).is_some()
}

/// What Cargo selects: these packages, or the whole workspace where that is built already.
pub fn selection<'a>(packages: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    if all_built() {
        return vec!["--workspace"];
    }
    packages.into_iter().flat_map(|package| ["--package", package]).collect()
}

fn built_with_all(binary: &str) -> Option<PathBuf> {
    let path = target_folder().join("debug").join(binary);
    (all_built() && path.is_file()).then_some(path)
}

/// Where a program of a package is, built.
///
/// # Errors
/// It does not build.
pub fn built(package: &str, binary: &str) -> Result<PathBuf> {
    if let Some(path) = built_with_all(binary) {
        return Ok(path);
    }
    let mut build = cargo();
    build.args(["build", "--quiet", "--package", package, "--bin", binary]);
    ensure!(succeeds(&mut build)?, "{binary} does not build");
    Ok(target_folder().join("debug").join(binary))
}

/// A program of a package, ready for its arguments: as it was built with all tests, or built now.
pub fn program(package: &str, binary: &str) -> Command {
    if let Some(built) = built_with_all(binary) {
        let mut command = Command::new(built);
        command.current_dir(root());
        return command;
    }
    let mut command = cargo();
    command.args(["run", "--quiet", "--package", package, "--bin", binary, "--"]);
    command
}

/// Runs to the end; true if it succeeded.
///
/// # Errors
/// The program cannot be started.
pub fn succeeds(command: &mut Command) -> Result<bool> {
    let shown = format!("{command:?}");
    let status = command.status().with_context(|| format!("cannot start {shown}"))?;
    Ok(status.success())
}

/// What it prints, or `None` if it cannot be started or fails.
pub fn output(command: &mut Command) -> Option<String> {
    let output = command.stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A program is on the path.
pub fn is_installed(program: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(program).is_file()))
}

/// The test among cargo's messages, one JSON object a line: the package's programs are built for it too, and come in any
/// order.
pub fn test_executable(messages: &str) -> Option<PathBuf> {
    messages.lines().find_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        let is_test = message.get("profile")?.get("test")?.as_bool()?;
        message.get("executable")?.as_str().filter(|_| is_test).map(PathBuf::from)
    })
}

#[cfg(test)]
mod tests {
    use super::test_executable;

    #[test]
    fn the_test_is_found_among_the_programs_that_are_built_with_it() {
        let program = r#"{"profile":{"test":false},"executable":"/a/floorguard-wired"}"#;
        let test = r#"{"profile":{"test":true},"executable":"/a/faults-12"}"#;
        let library = r#"{"profile":{"test":false},"executable":null}"#;
        for order in [[library, test, program], [program, library, test], [test, library, program]] {
            assert_eq!(test_executable(&order.join("\n")).unwrap().to_str(), Some("/a/faults-12"));
        }
        assert_eq!(test_executable(&[library, program].join("\n")), None);
    }
}
