//! Report and explanation in five languages: what stays the same in all of them was forgotten.

use std::path::Path;
use std::process::{Command, Output};

const LANGUAGES: [&str; 5] = ["en", "de", "fr", "it", "es"];
/// What is the same in all languages: units, names of this program, of the run and of places.
const SAME: [&str; 8] =
    ["robot", "supermarket", "floorguard", "run.mcap", "m/s", "Supermarket", "FG-REQ-", " UTC"];

fn floorguard(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output();
    let output = output.expect("the program starts");
    assert!(matches!(output.status.code(), Some(0 | 1)), "{arguments:?}: {output:?}");
    output
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

/// What people read of a page, piece by piece: text and labels, without what says itself to be English.
fn spoken(html: &str) -> Vec<String> {
    let (mut pieces, mut rest, mut skip) = (Vec::new(), html, None);
    while let Some((before, tag)) = rest.split_once('<') {
        let (tag, after) = tag.split_once('>').expect("a tag ends");
        if skip.is_none() {
            pieces.push(before.trim().to_owned());
            let label = tag.split_once("aria-label=\"").and_then(|(_, label)| label.split_once('"'));
            pieces.extend(label.map(|(label, _)| label.to_owned()));
        }
        let name = tag.split([' ', '/']).next().unwrap_or_default();
        let is_foreign = tag.contains(" lang=en") || ["script", "style"].contains(&name);
        match skip {
            None if is_foreign => skip = Some(format!("/{name}")),
            Some(ref end) if tag == end.as_str() => skip = None,
            _ => {}
        }
        rest = after;
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// Pieces that each language says as English does.
fn forgotten(pages: &[Vec<String>; 5]) -> Vec<&String> {
    let [english, others @ ..] = pages;
    for (other, code) in others.iter().zip(&LANGUAGES[1..]) {
        assert_eq!(other.len(), english.len(), "{code} has other pieces");
    }
    let is_word = |piece: &str| piece.chars().filter(|letter| letter.is_alphabetic()).count() > 2;
    let same =
        |index: usize, piece: &String| is_word(piece) && others.iter().all(|other| other[index] == *piece);
    let pieces = english.iter().enumerate().filter(|(index, piece)| same(*index, piece));
    pieces.map(|(_, piece)| piece).filter(|piece| !SAME.iter().any(|word| piece.contains(word))).collect()
}

#[test]
fn written_pages_speak_five_languages() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("run.mcap");
    let run =
        ["simulate", "--scenario", "supermarket", "--strategy", "guarantee", "--duration", "24", "--json"];
    let more = ["--emergency-stop", "15..17", "--record", text(&recording)];
    floorguard(&[run.as_slice(), &more].concat());
    let written = |command: &[&str], code: &str| {
        let page = folder.path().join(format!("{}-{code}.html", command[0]));
        let asked = [command, &[text(&recording), "--language", code, "--out", text(&page)]].concat();
        let output = floorguard(&asked);
        let html = std::fs::read_to_string(page).expect("a page");
        assert!(html.contains(&format!("<html lang=\"{code}\">")), "{code}");
        assert!(html.contains("prefers-color-scheme:dark"), "a page for the dark");
        (spoken(&html), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    for command in [["report"].as_slice(), &["explain", "--at", "15.2"]] {
        let pages = LANGUAGES.map(|code| written(command, code).0);
        assert!(pages[0].len() > 60, "{}", pages[0].len());
        let forgotten = forgotten(&pages);
        assert!(forgotten.is_empty(), "{command:?}: {forgotten:#?}");
    }
    let [english, german] = ["en", "de"].map(|code| written(&["explain", "--at", "15.2"], code).1);
    assert!(english.contains("decided by") && english.contains("emergency stop pressed"), "{english}");
    assert!(german.contains("entschied") && german.contains("Not-Halt gedrückt"), "{german}");
    let data = floorguard(&["explain", text(&recording), "--at", "15.2", "--language", "de", "--json"]);
    let data = String::from_utf8_lossy(&data.stdout).into_owned();
    assert!(data.contains("emergency stop pressed"), "data are in English: {data}");
}
