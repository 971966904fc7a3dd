//! Starts other programs, with their output on the terminal and their failure in plain words.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use anyhow::{Context, Result};

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

/// The test of a package among cargo's messages, one JSON object a line: programs and tests of other packages are built beside it,
/// and come in any order.
pub fn test_executable(messages: &str, package: &str) -> Option<PathBuf> {
    messages.lines().find_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        let is_test = message.get("profile")?.get("test")?.as_bool()?;
        let is_of_package = name_in(message.get("package_id")?.as_str()?) == package;
        message.get("executable")?.as_str().filter(|_| is_test && is_of_package).map(PathBuf::from)
    })
}

/// The package's name in cargo's identifier: `PLACE#NAME@VERSION`, or `PLACE/NAME#VERSION` where the folder has the name.
fn name_in(identifier: &str) -> &str {
    let (place, behind) = identifier.rsplit_once('#').unwrap_or((identifier, ""));
    match behind.split_once('@') {
        Some((name, _)) => name,
        None => place.rsplit('/').next().unwrap_or(place),
    }
}

#[cfg(test)]
mod tests {
    use super::test_executable;

    #[test]
    fn test_is_found_among_built_programs() {
        let line = |package: &str, is_test: bool, executable: &str| {
            format!(
                r#"{{"package_id":"{package}","profile":{{"test":{is_test}}},"executable":{executable}}}"#
            )
        };
        let program = line("path+file:///a/tests#robot-tests@0.1.0", false, r#""/a/wired""#);
        let test = line("path+file:///a/tests#robot-tests@0.1.0", true, r#""/a/faults-12""#);
        let other = line("path+file:///a/guard#0.1.0", true, r#""/a/guard-7""#);
        let library = line("path+file:///a/guard#0.1.0", false, "null");
        let found = |lines: &[&String], package| {
            let lines: Vec<&str> = lines.iter().map(|line| line.as_str()).collect();
            test_executable(&lines.join("\n"), package)
        };
        for order in [[&library, &test, &program, &other], [&other, &program, &library, &test]] {
            assert_eq!(found(&order, "robot-tests").unwrap().to_str(), Some("/a/faults-12"));
            assert_eq!(found(&order, "guard").unwrap().to_str(), Some("/a/guard-7"));
        }
        assert_eq!(found(&[&library, &program], "robot-tests"), None);
    }
}
