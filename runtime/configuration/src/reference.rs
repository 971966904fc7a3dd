//! The reference of `robot.toml`, out of the reading itself: every key that is asked for, with what is allowed.

use std::fmt::Write;

use super::asked::{Asked, asked_during};

/// More sections that the example robot does not have.
const OPTIONAL: &str = "
[mission]
map = \"hall.yaml\"
strategy = \"systematic\"
[navigation]
[learning]
[[field]]
direction = \"forward\"
speed_max_mps = 0.3
protective_m = [[-0.60, -0.60], [1.40, -0.60], [1.40, 0.60], [-0.60, 0.60]]
warning_m = [[-0.80, -0.80], [1.90, -0.80], [1.90, 0.80], [-0.80, 0.80]]
";

/// The scanner of the example robot, and the other one: each is asked for what the other does not have.
const LINE_SCANNER: &str = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";
const NETWORK_SCANNER: &str = "model = \"microscan3\"\nsource = \"udp:0.0.0.0:6060\"\n";

/// Every key with its kind, what is allowed, its default, and its value in the example robot, as Markdown.
#[must_use]
pub fn reference() -> String {
    let with_all = [super::EXAMPLE, "\n", super::camera::EXAMPLE_SECTION, OPTIONAL].concat();
    let mut rows = rows_of(&with_all);
    let others = rows_of(&with_all.replace(LINE_SCANNER, NETWORK_SCANNER));
    let is_new = |row: &Asked| !rows.iter().any(|known| known.is_of(&row.section, row.key));
    let others: Vec<Asked> = others.into_iter().filter(is_new).collect();
    rows.extend(others);
    // A section is asked on behind the one within it: its keys stand together all the same.
    let order: Vec<String> = rows.iter().map(|row| row.section.clone()).collect();
    rows.sort_by_key(|row| order.iter().position(|section| *section == row.section));
    let mut text = String::from(HEAD);
    let mut section = String::new();
    for row in rows {
        let name = row.section.clone();
        if name != section {
            let _ =
                write!(text, "\n## `[{name}]`\n\n| key | kind | allowed | without it |\n|---|---|---|---|\n");
            section.clone_from(&name);
        }
        let without = row.default.unwrap_or_else(|| "refused".to_owned());
        let _ = writeln!(text, "| `{}` | {} | {} | {without} |", row.key, row.kind, row.allowed);
    }
    let _ = write!(
        text,
        "\n## A floor camera\n\n```toml\n{}```\n\n## The example robot\n\n```toml\n{}```\n",
        super::camera::EXAMPLE_SECTION,
        super::EXAMPLE
    );
    text
}

/// What is asked for while a text is read, each key once: `[[field]]` is asked for as often as it stands there.
fn rows_of(configuration: &str) -> Vec<Asked> {
    let (read, asked) = asked_during(|| super::parse("robot.toml", configuration));
    debug_assert!(read.is_ok(), "the example is a right configuration");
    let mut rows = Vec::<Asked>::new();
    for mut row in asked {
        row.section.truncate(row.section.trim_end_matches(|c: char| c.is_ascii_digit() || c == ' ').len());
        if !rows.iter().any(|known| known.is_of(&row.section, row.key)) {
            rows.push(row);
        }
    }
    rows
}

const HEAD: &str = "# Configuration reference

Made from the code that reads `robot.toml`, by `FLOORGUARD_REFRESH=1 cargo test -p floorguard-configuration reference`; a
test fails when this page is old. `floorguard check robot.toml` tells every mistake of a file with line, limit and remedy.

Units stand at the end of each key. The robot's frame lies on the floor in the middle of the rear axle, x forward, y left,
z up.

`[imu]`, `[guard]`, `[route]`, `[camera]`, `[mission]`, `[navigation]`, `[learning]` and every `[[field]]` may be missing as a whole. Fields follow from
`[robot]` and `[limits]`; what is drawn in `[[field]]` must contain them and is added. `[learning]`: the robot corrects its
classifier of people from the tracks that it sees (hosted only; `run`, and `simulate` and `demo` with `--robot FILE`; a replay learns
as its recording did). `model` is relative to the folder of this file. The guard hears of what was learned only where that adds a
person: no stop is loosened by it. `[navigation]` is how `goto` drives on a map, and `simulate --navigate` on that of its
scenario; `start_…` is where the robot is switched on, in the map's frame. In `[scanner]`, `baud` is an S300's; `beams` and `sender` are a microScan3's, whose `source` is like
the lidar's. No two devices share a line, a UDP port or a bit of the safety controller's image, and an S300's `baud` is 500000, 250000,
125000 or 115200: at any other its scans come too late, or not at all.

In `[inputs]`, `reset_bit` and `start_bit` are push buttons of the operator, 1 = pressed: with them a robot without panel and terminal can
be reset and started, for example as a service. A button acts when it is released, after 0.03 to 5 s: one that is stuck or tied down
does nothing. Wire them to the safety controller beside the emergency stop, where one sees the whole robot; `inverted_bits` does not
concern them. A recording holds what the buttons did, because it holds the frames of the bus.
";

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn configuration_page_matches_the_code() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/configuration.md");
        let made = super::reference();
        assert!(made.matches("\n| `").count() > 50, "{made}");
        let scanner =
            made.split("## `[scanner]`").nth(1).and_then(|rest| rest.split("\n## ").next()).unwrap_or("");
        for key in ["baud", "beams", "sender"] {
            assert_eq!(scanner.matches(&format!("| `{key}` |")).count(), 1, "{key}: {scanner}");
        }
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
