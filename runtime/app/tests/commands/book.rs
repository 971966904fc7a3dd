//! The book and the README stay true: chapters and pictures exist, every command is one, and the tutorials' commands are
//! typed, one after the other, as a stranger would.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use floorguard_app::commands::Arguments;

/// Longer runs of the tutorials are cut to this, seconds.
const SECONDS_MAX: f64 = 6.0;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn book() -> PathBuf {
    root().join("docs/src")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn chapters() -> Vec<(PathBuf, String)> {
    let files = std::fs::read_dir(book()).expect("the book").map(|entry| entry.expect("a file").path());
    let chapters = files.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    chapters.map(|path| (path.clone(), read(&path))).collect()
}

/// The book, and what else tells people what to type.
fn texts() -> Vec<(PathBuf, String)> {
    let others =
        ["README.md", "BENCHMARKS.md", "ARCHITECTURE.md", "docs/safety-manual.md", "docs/requirements.md"];
    chapters().into_iter().chain(others.map(|name| (root().join(name), read(&root().join(name))))).collect()
}

/// Targets of links and pictures within the repository.
fn targets(text: &str) -> BTreeSet<&str> {
    let links = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    links.filter(|target| !target.contains("://") && !target.starts_with('#')).collect()
}

#[test]
fn links_resolve_and_chapters_are_listed() {
    let summary = read(&book().join("SUMMARY.md"));
    for (path, text) in texts() {
        let folder = path.parent().expect("a folder");
        for target in targets(&text) {
            let target = target.split('#').next().unwrap_or_default();
            assert!(folder.join(target).exists(), "{}: {target} does not exist", path.display());
        }
    }
    for (path, _) in chapters() {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        assert!(name == "SUMMARY.md" || targets(&summary).contains(name.as_str()), "{name} is not listed");
    }
}

/// Lines between fences that call the program, without comments; `cargo run -- ` is another way to call it.
fn typed(text: &str) -> Vec<String> {
    let code = text.split("```").skip(1).step_by(2).flat_map(str::lines);
    let calls = code.filter_map(|line| {
        let line = line.split(" #").next().unwrap_or(line).trim();
        let rest =
            line.strip_prefix("cargo run").map(|rest| rest.split_once("-- ").map_or("", |(_, rest)| rest));
        rest.or_else(|| line.strip_prefix("floorguard "))
    });
    // What follows is the shell's.
    calls
        .map(|call| format!("floorguard {}", call.split(['>', '|', '&']).next().unwrap_or(call).trim()))
        .collect()
}

#[test]
fn every_command_between_fences_is_one() {
    let mut commands = 0;
    for (path, text) in texts() {
        for line in typed(&text) {
            let parsed = Arguments::try_parse_from(line.split_whitespace());
            if let Err(error) = parsed {
                panic!("{}: {line}: {error}", path.display());
            }
            commands += 1;
        }
    }
    assert!(commands >= 14, "{commands}");
}

/// Every option below a command, at any depth.
fn options(command: &clap::Command) -> BTreeSet<String> {
    let own = command.get_arguments().filter_map(|argument| argument.get_long().map(str::to_owned));
    own.chain(command.get_subcommands().flat_map(options)).collect()
}

/// Placeholders, and lists of what could stand there.
fn is_pattern(call: &str) -> bool {
    call.contains(['|', ',', '[', '…'])
        || call.contains("...")
        || call.split_whitespace().any(|word| word.chars().filter(char::is_ascii_uppercase).count() > 1)
        || call.split_whitespace().any(|word| word == "N")
}

/// In running text, in tables and in the README: the command exists, and so does each option that is named with it. A call
/// without placeholders is one that the program takes, or one that only lacks what it is about.
#[test]
fn documented_commands_exist_with_options() {
    let program = Arguments::command();
    let mut found = 0;
    for (path, text) in texts() {
        // Outside of fences every second piece between backquotes is code.
        let prose = text.split("```").step_by(2).collect::<String>();
        let code = prose.split('`').skip(1).step_by(2).filter_map(|code| code.strip_prefix("floorguard "));
        for call in code {
            // What follows is the shell's.
            let call = call.split(" > ").next().unwrap_or(call);
            let call = call.split_whitespace().collect::<Vec<_>>().join(" ");
            check_call(&program, &call)
                .unwrap_or_else(|why| panic!("{}: `floorguard {call}`: {why}", path.display()));
            found += 1;
        }
    }
    assert!(found >= 30, "{found}");
}

fn check_call(program: &clap::Command, call: &str) -> Result<(), String> {
    let names = call.split_whitespace().next().unwrap_or_default();
    for name in names.split('|').filter(|name| *name != "help" && !name.starts_with('-')) {
        let command = program.find_subcommand(name).ok_or_else(|| format!("no command {name}"))?;
        let known = options(command);
        let named = call.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        for option in named.filter_map(|word| word.strip_prefix("--")) {
            if !known.contains(option) {
                return Err(format!("no option --{option}"));
            }
        }
    }
    if is_pattern(call) {
        return Ok(());
    }
    let words = std::iter::once("floorguard").chain(call.split_whitespace());
    match Arguments::try_parse_from(words) {
        Ok(_) => Ok(()),
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::MissingRequiredArgument
                    | ErrorKind::MissingSubcommand
                    | ErrorKind::DisplayHelp
                    | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
            ) =>
        {
            Ok(())
        }
        Err(error) => Err(error.to_string()),
    }
}

/// What strangers bring to the tutorial of recordings, and what stands for it here.
const BROUGHT: [(&str, &str); 3] = [
    ("drive.mcap", "no bag is at hand"),
    ("hall.pcap.gz", "vlp16_packets/timm_hall_last_300rpm.pcap.gz"),
    ("intel.clf", "slam2d_logs/corrected_freiburg-101.log.gz"),
];

/// The call as it is typed here: a short run, no real devices, no panel that waits for somebody. None when it is not for a test.
fn rehearsed(line: &str) -> Option<Vec<String>> {
    let mut words: Vec<String> = line.split_whitespace().skip(1).map(str::to_owned).collect();
    let command = words.first()?.clone();
    // The demo takes half a minute and is run by others; devices are not here; a black box needs a stop of a real run.
    if matches!(command.as_str(), "demo" | "run" | "blackbox" | "help")
        || words.iter().any(|w| w == "--panel")
    {
        return None;
    }
    if let Some(at) = words.iter().position(|word| word == "--duration") {
        let seconds: f64 = words.get(at + 1)?.parse().ok()?;
        words[at + 1] = seconds.min(SECONDS_MAX).to_string();
    }
    Some(words)
}

/// The folder in which a stranger works: a configuration, and what was brought.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = |from: PathBuf, name: &str| match std::fs::copy(&from, folder.path().join(name)) {
        Ok(_) => {}
        Err(_) => println!("skipped: {} is absent", from.display()),
    };
    copy(root().join("robot.toml"), "robot.toml");
    for (name, source) in BROUGHT {
        // The name that the book gives, with the packing of the file that is here.
        let packing = if source.ends_with(".gz") && !name.ends_with(".gz") { ".gz" } else { "" };
        copy(root().join("../shared/data").join(source), &format!("{name}{packing}"));
    }
    folder
}

#[test]
fn the_tutorials_do_what_they_say() {
    let mut done = 0;
    // One folder: the later chapters use what the first one has made.
    let folder = folder();
    for name in ["tutorial-simulator.md", "tutorial-recording.md", "seeing.md"] {
        for line in typed(&read(&book().join(name))) {
            let Some(words) = rehearsed(&line) else { continue };
            let (mut absent, mut words) = (false, words);
            for word in &mut words {
                let brought = BROUGHT.iter().any(|(name, _)| name == word);
                let packed = folder.path().join(format!("{word}.gz"));
                if brought && packed.exists() {
                    word.push_str(".gz");
                } else if brought && !folder.path().join(&*word).exists() {
                    absent = true;
                }
            }
            if absent {
                println!("skipped: {line}: its input is absent");
                continue;
            }
            let mut program = Command::new(env!("CARGO_BIN_EXE_floorguard"));
            let output =
                program.args(&words).current_dir(folder.path()).output().expect("the program starts");
            let stderr_text = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{name}: {line}, typed as {words:?}: {stderr_text}");
            done += 1;
        }
    }
    assert!(done >= 5, "{done}");
}

/// Each command's help ends with something that can be typed.
#[test]
fn each_help_has_an_example_that_parses() {
    for command in Arguments::command().get_subcommands() {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        let typed = |line: &'_ str| line.find("floorguard ").map(|at| line[at..].to_owned());
        let examples: Vec<String> = help.lines().filter_map(typed).collect();
        let own = format!("floorguard {} ", command.get_name());
        let has_own = examples.iter().any(|example| format!("{example} ").starts_with(&own));
        assert!(help.starts_with("Example") && has_own, "{own}: {help}");
        for example in examples {
            let typed = example.split(" > ").next().unwrap_or_default();
            // Words in quotes are one.
            let words = typed.split('"').enumerate().flat_map(|(index, part)| match index % 2 {
                0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
                _ => vec![part.to_owned()],
            });
            let words: Vec<String> = words.collect();
            let parsed = Arguments::try_parse_from(&words);
            assert!(parsed.is_ok(), "{example}: {:?}", parsed.err().map(|error| error.to_string()));
        }
    }
}
