//! The tests of the workspace, several test programs side by side. Cargo runs one after the other, and at the end of each all cores but
//! one have nothing to do.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;

use anyhow::{Context, Result, bail};

use crate::shell;

/// Programs at once; each has as many threads as cores are left to it.
const PROGRAMS_MAX: usize = 4;

/// Something that ends with a harness's closing line.
#[derive(Clone, Debug, PartialEq)]
struct TestProgram {
    /// Of the program; none: the examples in the documentation, which cargo runs.
    path: Option<PathBuf>,
    /// Folder of its package, where cargo would run it.
    folder: PathBuf,
    /// The words behind `cargo test` that repeat it.
    words: Vec<String>,
    /// Bytes: programs with much in them take long, and begin first.
    size: u64,
}

/// Builds all tests and runs them; every failed program is named with the command that repeats it.
pub fn run() -> Result<bool> {
    let mut build = shell::cargo();
    build.args(["test", "--workspace", "--no-run", "--message-format", "json-render-diagnostics"]);
    let built = build.stderr(Stdio::inherit()).output().context("cannot start cargo")?;
    if !built.status.success() {
        bail!("the tests do not build; repeat it with: cargo test --workspace --no-run");
    }
    let mut programs = programs_of(&String::from_utf8_lossy(&built.stdout));
    let size = |path: &Path| path.metadata().map_or(0, |file| file.len());
    for program in &mut programs {
        program.size = program.path.as_deref().map_or(u64::MAX, size);
    }
    programs.sort_by_key(|program| std::cmp::Reverse(program.size));
    let failed = run_all(programs.into());
    for words in &failed {
        println!("failed: cargo test {}", words.join(" "));
    }
    Ok(failed.is_empty())
}

/// The test programs among cargo's messages, one JSON object a line, and the examples in the documentation.
fn programs_of(messages: &str) -> Vec<TestProgram> {
    let documentation = ["--workspace", "--doc", "--no-fail-fast"].map(str::to_owned).to_vec();
    let examples = TestProgram { path: None, folder: shell::root(), words: documentation, size: 0 };
    let program = |line: &str| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        let is_test = message["profile"]["test"].as_bool()?;
        let path = PathBuf::from(message["executable"].as_str().filter(|_| is_test)?);
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?.to_path_buf();
        let (target, manifest) = (&message["target"], folder.join("Cargo.toml"));
        let name = target["name"].as_str()?.to_owned();
        let kind = target["kind"][0].as_str()?;
        let which = match kind {
            "lib" | "proc-macro" => vec!["--lib".to_owned()],
            kind => vec![format!("--{kind}"), name],
        };
        let words = ["--manifest-path".to_owned(), manifest.display().to_string()].into_iter().chain(which);
        Some(TestProgram { path: Some(path), words: words.collect(), folder, size: 0 })
    };
    messages.lines().filter_map(program).chain([examples]).collect()
}

/// Runs all, the first ones first; gives the words of those that failed.
fn run_all(programs: VecDeque<TestProgram>) -> Vec<Vec<String>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let workers = cores.min(PROGRAMS_MAX);
    let threads = cores.div_ceil(workers);
    let (waiting, failed) = (Mutex::new(programs), Mutex::new(Vec::new()));
    let shown = Mutex::new(());
    // On its own, so that the queue is free again while a program runs.
    let next = || locked(&waiting).pop_front();
    let work = || {
        while let Some(program) = next() {
            let (text, succeeded) = ran(&program, threads);
            let _one_at_a_time = locked(&shown);
            println!("{text}");
            if !succeeded {
                locked(&failed).push(program.words);
            }
        }
    };
    thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn locked<T>(inside: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    inside.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// What a program printed, and whether it ended well.
fn ran(program: &TestProgram, threads: usize) -> (String, bool) {
    let mut command = match &program.path {
        Some(path) => Command::new(path),
        None => shell::cargo(),
    };
    match &program.path {
        Some(_) => command.args(["--test-threads", &threads.to_string()]),
        None => command.arg("test").args(&program.words),
    };
    command.current_dir(&program.folder).env("CARGO_MANIFEST_DIR", &program.folder);
    let name = program.path.as_deref().unwrap_or(Path::new("examples in the documentation"));
    match command.stdin(Stdio::null()).output() {
        Ok(output) => {
            let texts =
                [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
            (format!("     Running {}\n{}{}", name.display(), texts[0], texts[1]), output.status.success())
        }
        Err(error) => (format!("{}: cannot be started: {error}", name.display()), false),
    }
}

#[cfg(test)]
mod tests {
    use super::{TestProgram, programs_of, run_all};

    #[test]
    fn test_programs_are_found_among_messages() {
        let message = |name: &str, kind: &str, is_test: bool| {
            format!(
                "{{\"manifest_path\":\"/a/{name}/Cargo.toml\",\"target\":{{\"name\":\"{name}\",\"kind\":[\"{kind}\"]}},\
                 \"profile\":{{\"test\":{is_test}}},\"executable\":\"/t/{name}-1\"}}"
            )
        };
        let text = [
            message("one", "lib", true),
            message("two", "bin", false),
            "{\"reason\":\"build-finished\"}".to_owned(),
            message("three", "test", true),
            "no JSON".to_owned(),
        ];
        let found = programs_of(&text.join("\n"));
        let words: Vec<String> = found.iter().map(|program| program.words.join(" ")).collect();
        assert_eq!(
            words,
            [
                "--manifest-path /a/one/Cargo.toml --lib",
                "--manifest-path /a/three/Cargo.toml --test three",
                "--workspace --doc --no-fail-fast"
            ]
        );
    }

    /// Two programs that wait for one another end only if they run at once.
    #[test]
    fn programs_run_at_once() {
        if std::thread::available_parallelism().map_or(1, usize::from) < 2 {
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let program = |name: &str, own: &str, other: &str| {
            use std::os::unix::fs::PermissionsExt as _;
            let path = folder.path().join(name);
            let wait = format!(
                "#!/bin/sh\ntouch {own}\nfor _ in $(seq 100); do [ -e {other} ] && exit 0; sleep 0.1; done\nexit 1\n"
            );
            std::fs::write(&path, wait).unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
            TestProgram {
                path: Some(path),
                folder: folder.path().into(),
                words: vec![name.to_owned()],
                size: 0,
            }
        };
        let both = [program("one", "a", "b"), program("two", "b", "a")];
        assert_eq!(run_all(both.to_vec().into()), Vec::<Vec<String>>::new());
    }

    /// Programs of the system stand for tests: one that ends well, one that does not, and one that there is not.
    #[test]
    fn failed_programs_are_named() {
        let program = |path: &str| TestProgram {
            path: Some(path.into()),
            folder: "/".into(),
            words: vec![path.to_owned()],
            size: 0,
        };
        let all = ["true", "false", "/no/such/program", "true"].map(program);
        let mut failed = run_all(all.to_vec().into()).concat();
        failed.sort();
        assert_eq!(failed, ["/no/such/program", "false"]);
    }
}
