//! Text that is put into a file in several places at once, and what each piece of it belongs to.

use std::ops::Range;

/// One change of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// Bytes that go.
    pub gone: Range<usize>,
    /// What comes in their place.
    pub text: String,
    /// Where it goes among others of the same byte.
    pub order: Order,
    /// The mutants that it belongs to.
    pub mutants: Vec<usize>,
}

/// Among edits of one byte: what closes the syntax before it, inner ones first; then what opens, outer ones first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Closes syntax of this many levels, counted from the innermost.
    Closes(std::cmp::Reverse<usize>),
    /// Opens syntax of this many levels, counted from the outermost.
    Opens(usize),
}

/// A text after its edits.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Edited {
    /// The text.
    pub text: String,
    /// Bytes of it that came from edits, with their mutants.
    pub pieces: Vec<(Range<usize>, Vec<usize>)>,
}

/// Applies the edits. What lies within bytes that are gone is left out.
pub fn apply(text: &str, mut edits: Vec<Edit>) -> Edited {
    edits.sort_by_key(|edit| (edit.gone.start, edit.order));
    let mut edited = Edited::default();
    let mut at = 0;
    for edit in edits {
        if edit.gone.start < at {
            continue;
        }
        edited.text.push_str(text.get(at..edit.gone.start).unwrap_or_default());
        let start = edited.text.len();
        edited.text.push_str(&edit.text);
        edited.pieces.push((start..edited.text.len(), edit.mutants));
        at = edit.gone.end;
    }
    edited.text.push_str(text.get(at..).unwrap_or_default());
    edited
}

#[cfg(test)]
mod tests {
    use std::cmp::Reverse;

    use super::*;

    #[test]
    fn nested_edits_open_outside_close_inside() {
        let edit = |gone, text: &str, order| Edit { gone, text: text.to_owned(), order, mutants: vec![] };
        let edits = vec![
            edit(1..1, ">", Order::Closes(Reverse(1))),
            edit(0..0, "<", Order::Opens(1)),
            edit(0..0, "(", Order::Opens(0)),
            edit(1..1, ")", Order::Closes(Reverse(0))),
            edit(1..2, "-", Order::Opens(0)),
        ];
        assert_eq!(apply("a+b", edits).text, "(<a>)-b");
    }
}
