//! The state of the robot in a few words, and its form as a table.

use owo_colors::OwoColorize;

/// A source and how it is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceStatus {
    /// Name of the source.
    pub name: String,
    /// Its health in one word.
    pub health: String,
    /// The guard accepts it.
    pub good: bool,
}

/// A snapshot for the live table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// Robot time since the start, seconds.
    pub elapsed_s: f64,
    /// Measured speed, m/s.
    pub speed_mps: f32,
    /// The guard's limit, m/s.
    pub limit_mps: f32,
    /// People tracked.
    pub people: usize,
    /// Stops so far.
    pub stops: u32,
    /// Cause of the last stop.
    pub last_stop: Option<String>,
    /// What limits or holds the robot now.
    pub held_by: Option<String>,
    /// How far the cleaning mission is, if there is one.
    pub mission: Option<String>,
    /// All sources.
    pub sources: Vec<SourceStatus>,
}

impl Status {
    /// The table, without a trailing newline; no line is wider than 80 columns. Colours only where wanted.
    #[must_use]
    pub fn table(&self, coloured: bool) -> String {
        let mut lines = vec![format!(
            "  speed   {:5.2} m/s   limit {:5.2} m/s   people {:3}   stops {:3}",
            self.speed_mps, self.limit_mps, self.people, self.stops
        )];
        lines.extend(self.mission.as_ref().map(|words| short(&format!("  mission {words}"))));
        for (index, pair) in self.sources.chunks(SOURCES_IN_A_ROW).enumerate() {
            let begin = if index == 0 { "  sources " } else { "          " };
            let cells: Vec<String> = pair.iter().map(|source| source_cell(source, coloured)).collect();
            lines.push(format!("{begin}{}", cells.concat()).trim_end().to_owned());
        }
        let [last_stop, held_by] =
            [&self.last_stop, &self.held_by].map(|cause| cause.as_deref().unwrap_or("none"));
        lines.push(short(&format!("  last stop: {last_stop}")));
        lines.push(short(&format!("  held by: {held_by}")));
        lines.join("\n")
    }

    /// The same in one line, for logs.
    #[must_use]
    pub fn line(&self) -> String {
        let bad = self.sources.iter().filter(|source| !source.good);
        let bad: Vec<String> = bad.map(|source| format!("{} ({})", source.name, source.health)).collect();
        let held = self.held_by.as_ref().map(|cause| format!("  held by: {cause}")).unwrap_or_default();
        format!(
            "{:7.1} s  speed {:.2} m/s  limit {:.2} m/s  people {}  stops {}  {}{held}",
            self.elapsed_s,
            self.speed_mps,
            self.limit_mps,
            self.people,
            self.stops,
            if bad.is_empty() {
                "all sources healthy".to_owned()
            } else {
                format!("not healthy: {}", bad.join(", "))
            },
        )
    }
}

/// Columns of the narrowest terminal that people use.
const COLUMNS: usize = 80;
/// Sources side by side, and the width of each.
const SOURCES_IN_A_ROW: usize = 3;
const SOURCE_COLUMNS: usize = 23;

/// At most as wide as a terminal; the end is left out.
fn short(line: &str) -> String {
    if line.chars().count() <= COLUMNS {
        return line.to_owned();
    }
    let kept: String = line.chars().take(COLUMNS - 1).collect();
    format!("{}…", kept.trim_end())
}

/// Of one width, with the colour around the words only.
fn source_cell(source: &SourceStatus, coloured: bool) -> String {
    let text: String =
        format!("{} {}", source.name, source.health).chars().take(SOURCE_COLUMNS - 1).collect();
    let space = " ".repeat(SOURCE_COLUMNS - text.chars().count());
    let text = match (coloured, source.good) {
        (false, _) => text,
        (true, true) => text.green().to_string(),
        (true, false) => text.red().to_string(),
    };
    text + &space
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_only_where_wanted() {
        let source = SourceStatus { name: "scanner".to_owned(), health: "stale".to_owned(), good: false };
        let status = Status { sources: vec![source], ..Status::default() };
        assert!(!status.table(false).contains('\u{1b}'));
        assert!(status.table(true).contains('\u{1b}'));
        assert!(status.line().ends_with("not healthy: scanner (stale)"));
    }

    #[test]
    fn table_fits_a_terminal_of_80_columns() {
        let names = [
            "safety scanner",
            "lidar",
            "wheel encoders",
            "inertial sensor",
            "drive",
            "safety inputs",
            "wanted command",
        ];
        let sources = names.map(|name| SourceStatus {
            name: name.to_owned(),
            health: "healthy".to_owned(),
            good: true,
        });
        let long = "person would be reached before standstill: 0.90 s, limit 1.02 s, 12 ms old -> stop and hold (category 2)";
        let status = Status {
            sources: sources.to_vec(),
            last_stop: Some(long.to_owned()),
            held_by: Some(long.to_owned()),
            mission: Some(long.to_owned()),
            ..Status::default()
        };
        let table = status.table(false);
        assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
        assert!(table.contains("wanted command healthy") && table.contains("held by: person"), "{table}");
        assert_eq!(table.lines().count(), 7);
    }
}
