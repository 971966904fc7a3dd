//! Counts named `cell | CLASS | SOURCE | PHASE`, as a table of what a campaign covered.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::block::Counts;

const CELL: &str = "cell | ";

/// The count belongs to a cell.
pub fn is_cell(name: &str) -> bool {
    name.starts_with(CELL)
}

/// A row for each class, a column for each source, in each field the runs by phase; `-` where the class cannot be.
/// `None` if the campaign has no matrix.
pub fn table(counts: &Counts) -> Option<String> {
    let mut fields = BTreeMap::<(&str, &str), Vec<(&str, u64)>>::new();
    for (name, count) in counts {
        let Some(name) = name.strip_prefix(CELL) else { continue };
        let mut parts = name.split(" | ");
        if let (Some(class), Some(source), Some(phase)) = (parts.next(), parts.next(), parts.next()) {
            fields.entry((class, source)).or_default().push((phase, *count));
        }
    }
    let classes: BTreeSet<&str> = fields.keys().map(|(class, _)| *class).collect();
    let sources: BTreeSet<&str> = fields.keys().map(|(_, source)| *source).collect();
    let phases: Vec<&str> = fields.values().next()?.iter().map(|(phase, _)| *phase).collect();
    let mut text =
        format!("  runs by phase ({}), - where the fault cannot be\n  {:18}", phases.join("/"), "");
    sources.iter().for_each(|source| {
        let _ = write!(text, " {source:>17}");
    });
    for class in &classes {
        let _ = write!(text, "\n  {class:18}");
        for source in &sources {
            let runs = fields
                .get(&(*class, *source))
                .map(|runs| runs.iter().map(|(_, count)| count.to_string()).collect::<Vec<_>>().join("/"));
            let _ = write!(text, " {:>17}", runs.unwrap_or_else(|| String::from("-")));
        }
    }
    let cells = fields.values().flatten();
    let (all, filled) = (cells.clone().count(), cells.filter(|(_, count)| *count > 0).count());
    let share = filled as f64 / all as f64 * 100.0;
    let _ = write!(
        text,
        "\n  {} classes; {filled} of {all} possible cells have a run: {share:.1} %",
        classes.len()
    );
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_become_a_table_and_a_share() {
        let counts = [
            ("cell | drop | lidar | hold", 2),
            ("cell | drop | lidar | start", 0),
            ("cell | flap | imu | hold", 1),
        ];
        let counts = counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
        let text = table(&counts).expect("a matrix");
        assert!(text.contains("2/0") && text.contains("2 of 3 possible cells have a run: 66.7 %"), "{text}");
        assert_eq!(table(&Counts::from([("steps".to_owned(), 3)])), None);
    }
}
