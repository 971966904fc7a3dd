//! Every comment and chapter of the repository, and planted citations that must be found.

use std::path::Path;

use super::comments::{files, paragraphs};
use super::refused::refused;
use super::sources::Sources;
use crate::shell;

fn of_the_book() -> Sources {
    Sources::read(&shell::root().join("docs/src"))
}

fn faults(sources: &Sources, path: &Path, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for paragraph in paragraphs(path, text) {
        let mut found = refused(&paragraph.text);
        found.extend(sources.missing(&paragraph.text));
        faults.extend(found.iter().map(|cited| format!("{}:{}: {cited}", path.display(), paragraph.line)));
    }
    faults
}

#[test]
fn every_citation_can_be_found() {
    let sources = of_the_book();
    assert!(sources.chapters.len() >= 30 && sources.references.len() >= 50, "{}", sources.chapters.len());
    let mut all = Vec::new();
    let mut cited = 0;
    for path in files(&shell::root()) {
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        cited += text.matches("book, ").count();
        all.extend(faults(&sources, &path, &text));
    }
    assert!(all.is_empty(), "{} citations lead nowhere:\n{}", all.len(), all.join("\n"));
    assert!(cited >= 300, "{cited} citations of the book");
}

#[test]
fn unfindable_citations_are_refused() {
    let sources = of_the_book();
    // A search of the sources for such citations shall not find these: ~ is a space, ^ a slash.
    let all = [
        "algorithms~D.4 | algorithms~H | Algorithms~K15 | wire-formats~3 | wire-formats,~section~6.1",
        "platform~4 | architecture~5 | style~guide~2 | issue~5 | issue~#12 | AMB-10 | DEV-25",
        "(D.4,~X.3) | (K15) | after~P0 | T-20 | X-05 | ..^shared^specs | see~wire-formats.md",
        "book,~Garden | book,~Guard:~Roses | book,~Guard:~Collisions | book,~SICK~S301 | Nobody~1999",
        "Nobody~et~al.~2014 | Hess~et~al.~2015 | Hess~and~Nobody~2014 | Yan~et~al.~(2020)",
    ];
    for cited in all.iter().flat_map(|line| line.split(" | ")) {
        let cited = cited.replace('~', " ").replace('^', "/");
        for text in [format!("/// Made so ({cited}).\nfn made() {{}}"), format!("let a = 1; // {cited}")] {
            let found = faults(&sources, Path::new("planted.rs"), &text);
            assert!(!found.is_empty(), "{cited} was not found");
        }
        let found = faults(&sources, Path::new("planted.md"), &format!("A text.\n\nMade so\nafter {cited}."));
        assert!(!found.is_empty(), "{cited} was not found in a text");
    }
}

#[test]
fn a_wrapped_citation_is_read_as_one() {
    let text = "/// Made so (book, Guard:\n/// Roses).\n";
    assert_eq!(faults(&of_the_book(), Path::new("a.rs"), text), ["a.rs:1: book, Guard: Roses)."]);
}

#[test]
fn what_can_be_found_is_accepted() {
    let sources = of_the_book();
    let all = [
        "book, Guard | book, Guard: Field length; book, SICK S300: Line",
        "the book, Xsens MTi: Test frames, both | book, microScan3 | Hess et al. 2014, section IV",
        "Chang and Lin 2011 | (Smith 1961) | O'Neill 2014 | Yan et al. 2020a | Monday 2026-04-06",
        "0.2, -0.1 | VLP-16 | FG-REQ-020 | ISO 13855:2010 | ../shared/data/velodyne",
        "a book, as it is",
    ];
    for cited in all.iter().flat_map(|line| line.split(" | ")) {
        let found = faults(&sources, Path::new("a.rs"), &format!("/// Made so ({cited}).\n"));
        assert!(found.is_empty(), "{found:?}");
        let code = format!("let text = \"{cited} D.4\";\n```\n");
        assert!(faults(&sources, Path::new("a.rs"), &code).is_empty(), "{code} is no comment");
    }
}
