//! Pieces of the safety manual that belong beside the verdicts: what the machine must provide, and what is not claimed.

use super::table::{escape, verdict};
use crate::facts::facts;

/// Words of the headings of the chapters that the page quotes.
pub const NOT_CLAIMED: &str = "What is not claimed";
pub const REACTION: &str = "How fast it reacts";
pub const ASSUMPTIONS: &str = "What the machine must provide";

/// A chapter of the manual, by the words of its heading, as HTML: paragraphs, lists and tables only. Where the manual
/// has no such chapter, or nothing in it, that is reported in its place.
pub fn chapter(manual: &str, heading: &str) -> String {
    let html = body_of(manual, heading);
    if html.is_empty() {
        let words = format!(
            "{} has no text under a heading with the words “{heading}”: nothing can be quoted here",
            facts().records.manual
        );
        return format!("<p>{}</p>", verdict(false, &words));
    }
    html
}

fn body_of(manual: &str, heading: &str) -> String {
    let lines =
        manual.lines().skip_while(|line| !(line.starts_with("## ") && line.contains(heading))).skip(1);
    let body: Vec<&str> = lines.take_while(|line| !line.starts_with("## ")).collect();
    let mut html = String::new();
    for block in body.join("\n").split("\n\n").map(str::trim).filter(|block| !block.is_empty()) {
        if block.starts_with("* ") {
            let items =
                block.split("\n* ").map(|item| format!("<li>{}", inline(item.trim_start_matches("* "))));
            html.push_str(&format!("<ul>{}</ul>", items.collect::<String>()));
        } else if block.starts_with('|') {
            let rows = block.lines().filter(|row| !row.starts_with("|--")).map(|row| {
                let cells =
                    row.trim_matches('|').split('|').map(|cell| format!("<td>{}", inline(cell.trim())));
                format!("<tr>{}</tr>", cells.collect::<String>())
            });
            html.push_str(&format!("<div class=wide><table>{}</table></div>", rows.collect::<String>()));
        } else {
            html.push_str(&format!("<p>{}</p>", inline(block)));
        }
    }
    html
}

/// Code and emphasis within a line.
pub fn inline(text: &str) -> String {
    let mut html = String::new();
    for (index, part) in escape(text).split('`').enumerate() {
        html.push_str(&if index % 2 == 1 { format!("<code>{part}</code>") } else { part.replace('*', "") });
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chapter_becomes_html() {
        let manual = "## 1. First\n\nno\n\n## 2. What is not claimed\n\nSome `a<b`.\n\n* one\n  more\n* two\n\n| a | b |\n|--|--|\n| 1 | 2 |\n\n## 3. Last\n\nno\n";
        let html = chapter(manual, "not claimed");
        assert!(html.contains("<code>a&lt;b</code>") && html.contains("<li>two"), "{html}");
        assert!(html.contains("<td>1<td>2") && !html.contains("no"), "{html}");
    }

    #[test]
    fn missing_or_empty_chapter_is_reported() {
        for manual in ["", "## 1. Other\n\ntext\n", "## 5. What is not claimed\n\n## 6. Next\n\ntext\n"] {
            let html = chapter(manual, NOT_CLAIMED);
            assert!(
                html.contains(&facts().records.manual)
                    && html.contains(NOT_CLAIMED)
                    && html.contains("class=bad"),
                "{html}"
            );
        }
    }

    #[test]
    fn manual_has_the_quoted_chapters() {
        let manual =
            std::fs::read_to_string(crate::shell::root().join(&facts().records.manual)).expect("the manual");
        for heading in [NOT_CLAIMED, REACTION, ASSUMPTIONS] {
            assert!(!body_of(&manual, heading).is_empty(), "{heading}");
        }
    }
}
