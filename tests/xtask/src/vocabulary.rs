//! Names and prose use the words of the field: `docs/src/vocabulary.md` decides which, and this refuses the others.

use std::collections::BTreeSet;
use std::path::Path;

use proc_macro2::{TokenStream, TokenTree};

use crate::citations::{files, paragraphs};
use crate::shell;

const TABLE: &str = "docs/src/vocabulary.md";
/// Entries of released versions stay as they were.
const HISTORY: &str = "CHANGELOG.md";
const TEST_WORDS_MAX: usize = 8;
/// A place shows this much of the text around a word, characters.
const AROUND: usize = 30;

/// One former word or phrase, and where it is refused.
struct Refused {
    word: String,
    in_names: bool,
    in_prose: bool,
}

/// The cells of all rows of a page with this many columns, without heads.
fn rows(page: &str, columns: usize) -> Vec<Vec<String>> {
    let lines = page.lines().filter_map(|line| line.strip_prefix('|')?.strip_suffix('|'));
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let rows = lines.map(cells).filter(|row| row.len() == columns);
    rows.filter(|row| !row.iter().any(|cell| cell.starts_with("---") || cell.contains("word"))).collect()
}

fn refused(page: &str) -> Vec<Refused> {
    let words = |row: &Vec<String>| {
        let (in_names, in_prose) = (row[2].contains("names"), row[2].contains("prose"));
        let words: Vec<String> =
            row[0].split(", ").map(|word| word.trim_matches('"').to_lowercase()).collect();
        words.into_iter().map(move |word| Refused { word, in_names, in_prose }).collect::<Vec<_>>()
    };
    let rows = rows(page, 3).into_iter().filter(|row| !row[1].starts_with('`'));
    let is_refused = |row: &Vec<String>| row[2].contains("names") || row[2].contains("prose");
    rows.filter(is_refused).flat_map(|row| words(&row)).collect()
}

/// The words of an identifier or of a file name, in small letters.
fn words_of(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        if !letter.is_alphanumeric() || (letter.is_uppercase() && was_small) {
            words.push(String::new());
        }
        was_small = letter.is_lowercase();
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Every identifier, and every literal with a space in it: a message.
fn tokens(stream: TokenStream, names: &mut BTreeSet<String>, messages: &mut Vec<String>) {
    for token in stream {
        match token {
            TokenTree::Group(group) => tokens(group.stream(), names, messages),
            TokenTree::Ident(name) => _ = names.insert(name.to_string()),
            TokenTree::Literal(text) if text.to_string().contains(' ') => messages.push(text.to_string()),
            TokenTree::Literal(_) | TokenTree::Punct(_) => {}
        }
    }
}

/// Where a word or phrase stands in a text, with what is around it.
fn find(text: &str, word: &str) -> Option<String> {
    let text = text.to_lowercase();
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let stands_alone = |at: &usize| {
        let (before, rest) = text.split_at(*at);
        !before.ends_with(is_letter)
            && !rest.get(word.len()..).is_some_and(|rest| rest.starts_with(is_letter))
    };
    let at = text.match_indices(word).map(|(at, _)| at).find(stands_alone)?;
    let before: String = text[..at].chars().rev().take(AROUND).collect();
    let behind: String = text[at..].chars().take(word.len() + AROUND).collect();
    Some(before.chars().rev().chain(behind.chars()).collect())
}

/// What a file has of the refused words, as far as no row allows it.
fn findings(path: &Path, text: &str, refused: &[Refused]) -> Vec<String> {
    let (mut names, mut messages) = (BTreeSet::new(), Vec::new());
    if path.extension().is_some_and(|extension| extension == "rs") {
        tokens(text.parse().unwrap_or_default(), &mut names, &mut messages);
        names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    }
    messages.extend(paragraphs(path, text).into_iter().map(|paragraph| paragraph.text));
    let mut found = Vec::new();
    for Refused { word, in_names, in_prose } in refused {
        let has = |name: &&String| *in_names && words_of(name).contains(word);
        found.extend(names.iter().filter(has).map(|name| format!("{word}: `{name}`")));
        let places = messages.iter().filter(|_| *in_prose).filter_map(|text| find(text, word));
        found.extend(places.map(|place| format!("{word}: … {place} …")));
    }
    found
}

fn is_allowed(finding: &str, path: &str, allowed: &[Vec<String>]) -> bool {
    let word = finding.split(':').next().unwrap_or_default();
    allowed.iter().any(|row| row[0] == word && path.ends_with(row[1].trim_matches('`')))
}

#[test]
fn names_and_prose_use_the_vocabulary() {
    let page = std::fs::read_to_string(shell::root().join(TABLE)).expect("the vocabulary");
    let refused = refused(&page);
    assert!(refused.len() >= 40, "{} words", refused.len());
    let allowed: Vec<_> = rows(&page, 3).into_iter().filter(|row| row[1].starts_with('`')).collect();
    let mut wrong = Vec::new();
    for path in files(&shell::root()) {
        let name = path.strip_prefix(shell::root()).unwrap_or(&path).display().to_string();
        if name == TABLE || name == HISTORY || name.ends_with("src/vocabulary.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = findings(&path, &text, &refused);
        let found = found.into_iter().filter(|finding| !is_allowed(finding, &name, &allowed));
        wrong.extend(found.map(|finding| format!("{name}: {finding}")));
    }
    assert!(wrong.is_empty(), "{} places, see {TABLE}:\n{}", wrong.len(), wrong.join("\n"));
}

/// The words of a test's name, without the requirements in front.
fn test_words(name: &str) -> usize {
    let mut words: Vec<&str> = name.split('_').collect();
    while let ["fg", "req", number, ..] = words[..] {
        let is_number = number.starts_with(|digit: char| digit.is_ascii_digit());
        words.drain(..if is_number { 3 } else { 2 });
    }
    words.len()
}

#[test]
fn test_names_have_eight_words() {
    let mut long = Vec::new();
    for path in files(&shell::root()) {
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a source");
        for behind in text.split("#[test]").skip(1) {
            let name = behind.split_once("fn ").and_then(|(_, name)| name.split('(').next());
            let name = name.filter(|name| test_words(name) > TEST_WORDS_MAX);
            long.extend(name.map(|name| format!("{}: {name}", path.display())));
        }
    }
    assert!(long.is_empty(), "{} names of tests are too long:\n{}", long.len(), long.join("\n"));
}

#[test]
fn former_words_are_found_as_whole_words() {
    let refused = refused("| eye, that is none | source | names, prose |");
    let found = |text: &str| findings(Path::new("folder.rs"), text, &refused).len();
    assert_eq!(found("struct FolderEye; // the eye, a number that is none"), 3);
    assert_eq!(found("struct Keyed; // eyelet"), 0);
    assert_eq!(findings(Path::new("folder_eye.rs"), "", &refused).len(), 1);
    assert_eq!(found("fn f() { print(\"an eye\"); g(\"eye\"); }"), 1);
    assert_eq!(test_words("fg_req_012_fg_req_013_two_words"), 2);
}
