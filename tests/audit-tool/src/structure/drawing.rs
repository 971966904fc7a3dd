//! The graphs as text, between two markers of a document.

use std::fmt::Write as _;

use super::graph::Graph;

const BEGIN: &str = "<!-- drawn by cargo xtask structure -->";
const END: &str = "<!-- end of what is drawn -->";

/// Crates as a diagram, modules as lines.
pub fn draw(crates: &Graph, modules: &[(String, Graph)]) -> String {
    let mut text = String::from("\n```mermaid\ngraph TD\n");
    let id = |folder: &str| folder.replace(['/', '-'], "_");
    for folder in crates.names() {
        let _ = writeln!(text, "  {}[\"{folder}\"]", id(folder));
    }
    let reduced = crates.reduced();
    for from in reduced.names() {
        reduced.of(from).for_each(|to| {
            let _ = writeln!(text, "  {} --> {}", id(from), id(to));
        });
    }
    text += "```\n\nArrows that others imply are left out. The top modules of each crate, users before what they use:\n\n```text\n";
    for (folder, graph) in modules {
        let _ = writeln!(text, "{folder}");
        for name in graph.ordered() {
            let known = graph.of(name).collect::<Vec<_>>().join(", ");
            let arrow = if known.is_empty() { "" } else { " → " };
            let _ = writeln!(text, "  {name}{arrow}{known}");
        }
    }
    text + "```\n"
}

/// What stands between the markers; `None` without them.
pub fn within(document: &str) -> Option<&str> {
    document.split_once(BEGIN)?.1.split_once(END).map(|(drawn, _)| drawn)
}

/// The document with something else between its markers; `None` without them.
pub fn replaced(document: &str, drawn: &str) -> Option<String> {
    let (before, rest) = document.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}{drawn}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_stays_between_the_markers() {
        let mut crates = Graph::default();
        crates.point("core/a-b", "core/c");
        let mut modules = Graph::default();
        modules.point("x", "y");
        let drawn = draw(&crates, &[("core/c".to_owned(), modules)]);
        assert!(
            drawn.contains("  core_a_b --> core_c\n") && drawn.contains("core/c\n  x → y\n  y\n"),
            "{drawn}"
        );
        let document = format!("Before.\n{BEGIN}old{END}\nAfter.\n");
        let new = replaced(&document, &drawn).expect("markers");
        assert_eq!(within(&new), Some(drawn.as_str()));
        assert!(new.starts_with("Before.\n") && new.ends_with("\nAfter.\n"));
        assert_eq!((within("none"), replaced("none", &drawn)), (None, None));
    }
}
