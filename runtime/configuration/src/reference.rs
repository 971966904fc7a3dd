//! The reference of `robot.toml`, out of the reading itself: every key that is asked for, with what is allowed.

use std::cell::RefCell;
use std::fmt::Write;

/// A key that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub section: String,
    pub key: &'static str,
    pub kind: &'static str,
    pub allowed: String,
    pub default: Option<String>,
}

thread_local! {
    static LIST: RefCell<Option<Vec<Asked>>> = const { RefCell::new(None) };
}

/// Takes note while a reference is made; else nothing.
pub(crate) fn note(asked: impl FnOnce() -> Asked) {
    LIST.with_borrow_mut(|list| {
        if let Some(list) = list {
            list.push(asked());
        }
    });
}

/// More sections that the example robot does not have.
const OPTIONAL: &str = "
[mission]
map = \"hall.yaml\"
strategy = \"systematic\"
[learning]
";

/// Every key with its kind, what is allowed, its default, and its value in the example robot, as Markdown.
#[must_use]
pub fn reference() -> String {
    LIST.set(Some(Vec::new()));
    let with_all = [super::EXAMPLE, "\n", super::camera::EXAMPLE_SECTION, OPTIONAL].concat();
    let read = super::parse("robot.toml", &with_all);
    let asked = LIST.take().unwrap_or_default();
    debug_assert!(read.is_ok(), "the example is a right configuration");
    let mut text = String::from(HEAD);
    let mut section = String::new();
    let mut seen: Vec<(String, &str)> = Vec::new();
    for row in asked {
        // `[[field]]` is asked for as often as it stands in the file.
        let name =
            row.section.trim_end_matches(|letter: char| letter.is_ascii_digit() || letter == ' ').to_owned();
        if seen.contains(&(name.clone(), row.key)) {
            continue;
        }
        if name != section {
            let _ =
                write!(text, "\n## `[{name}]`\n\n| key | kind | allowed | without it |\n|---|---|---|---|\n");
            section.clone_from(&name);
        }
        let without = row.default.unwrap_or_else(|| "refused".to_owned());
        let _ = writeln!(text, "| `{}` | {} | {} | {without} |", row.key, row.kind, row.allowed);
        seen.push((name, row.key));
    }
    let _ = write!(
        text,
        "\n## A floor camera\n\n```toml\n{}```\n\n## The example robot\n\n```toml\n{}```\n",
        super::camera::EXAMPLE_SECTION,
        super::EXAMPLE
    );
    text
}

const HEAD: &str = "# Configuration reference

Made from the code that reads `robot.toml`, by `FLOORGUARD_REFRESH=1 cargo test -p floorguard-configuration reference`; a
test fails when this page is old. `floorguard check robot.toml` tells every mistake of a file with line, limit and remedy.

Units stand at the end of each key. The robot's frame lies on the floor in the middle of the rear axle, x forward, y left,
z up.

`[imu]`, `[guard]`, `[route]`, `[camera]`, `[mission]` and `[learning]` may be missing as a whole. `[learning]`: the robot corrects its
classifier of people from the tracks that it sees (hosted only; `run`, and `simulate` and `demo` with `--robot FILE`; a replay learns
as its recording did). `model` is relative to the folder of this file. The guard hears of what was learned only where that adds a
person: no stop is loosened by it.
";

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn the_page_of_the_book_is_what_the_code_reads() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/configuration.md");
        let made = super::reference();
        assert!(made.matches("\n| `").count() > 50, "{made}");
        if std::env::var_os("FLOORGUARD_REFRESH").is_some() {
            std::fs::write(&page, &made).expect("the page is written");
        }
        let written = std::fs::read_to_string(&page).unwrap_or_default();
        assert!(
            written == made,
            "docs/src/configuration.md is old: FLOORGUARD_REFRESH=1 cargo test -p floorguard-configuration reference"
        );
    }
}
