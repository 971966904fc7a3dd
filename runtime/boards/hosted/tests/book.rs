//! The book stays true: its chapters and pictures exist, and its commands are commands.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Parser;
use floorguard_hosted::commands::Arguments;

fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/src")
}

fn chapters() -> Vec<(PathBuf, String)> {
    let files = std::fs::read_dir(book()).expect("the book").map(|entry| entry.expect("a file").path());
    let chapters = files.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    chapters.map(|path| (path.clone(), std::fs::read_to_string(&path).expect("a chapter"))).collect()
}

/// Targets of links and pictures within the repository.
fn targets(text: &str) -> BTreeSet<&str> {
    let links = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    links.filter(|target| !target.contains("://") && !target.starts_with('#')).collect()
}

#[test]
fn every_link_leads_somewhere_and_every_chapter_is_listed() {
    let summary = std::fs::read_to_string(book().join("SUMMARY.md")).expect("the summary");
    for (path, text) in chapters() {
        for target in targets(&text) {
            assert!(book().join(target).exists(), "{}: {target} does not exist", path.display());
        }
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        assert!(name == "SUMMARY.md" || targets(&summary).contains(name.as_str()), "{name} is not listed");
    }
}

#[test]
fn every_command_of_the_book_is_one() {
    let mut commands = 0;
    for (path, text) in chapters() {
        // Every second piece between fences is code.
        let code = text.split("```").skip(1).step_by(2).flat_map(str::lines);
        for line in code.filter(|line| line.starts_with("floorguard ")) {
            let parsed = Arguments::try_parse_from(line.split_whitespace());
            if let Err(error) = parsed {
                panic!("{}: {line}: {error}", path.display());
            }
            commands += 1;
        }
    }
    assert!(commands >= 12, "{commands}");
}
