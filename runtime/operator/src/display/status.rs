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
    /// All sources.
    pub sources: Vec<SourceStatus>,
}

impl Status {
    /// The table, without a trailing newline. Colours only where wanted.
    #[must_use]
    pub fn table(&self, coloured: bool) -> String {
        let sources: Vec<String> = self.sources.iter().map(|source| source_cell(source, coloured)).collect();
        let [last_stop, held_by] =
            [&self.last_stop, &self.held_by].map(|cause| cause.as_deref().unwrap_or("none"));
        format!(
            "  speed   {:5.2} m/s   limit {:5.2} m/s   people {:3}   stops {:3}\n  sources {}\n  last stop: {last_stop}\n  held by: {held_by}",
            self.speed_mps,
            self.limit_mps,
            self.people,
            self.stops,
            sources.join("  "),
        )
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

fn source_cell(source: &SourceStatus, coloured: bool) -> String {
    let text = format!("{} {}", source.name, source.health);
    match (coloured, source.good) {
        (false, _) => text,
        (true, true) => text.green().to_string(),
        (true, false) => text.red().to_string(),
    }
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
}
