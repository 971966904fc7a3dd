//! Mutants that cannot be a branch beside the others, such as those of constants: each is built by itself.

use anyhow::Result;

use super::list::Mutant;
use super::mutated_copy::MutatedCopy;
use super::outcome::Outcome;
use super::trial::Program;
use crate::facts::Part;
use crate::{copied_tree, shell};

/// Puts one mutant into the copy, asks the suites, and puts the text back.
pub fn try_out(mutated: &MutatedCopy, mutant: &Mutant, part: &Part) -> Result<Outcome> {
    let text = std::fs::read_to_string(shell::root().join(&mutant.file))?;
    let path = mutated.sources().join(&mutant.file);
    let others = std::fs::read_to_string(&path)?;
    copied_tree::write(&path, &changed(&text, mutant))?;
    let outcome = ask(mutated, part);
    copied_tree::write(&path, &others)?;
    outcome
}

fn ask(mutated: &MutatedCopy, part: &Part) -> Result<Outcome> {
    for suite in &part.suites {
        let Some(program) = Program::build(mutated, &part.package, suite)? else {
            return Ok(Outcome::Unviable);
        };
        if program.notices("none", &program.tests()?)? {
            return Ok(Outcome::Caught);
        }
    }
    Ok(Outcome::Survived(part.suites.len()))
}

fn changed(text: &str, mutant: &Mutant) -> String {
    let place = |place: super::list::Place| place.byte(text).unwrap_or(text.len());
    let head = text.get(..place(mutant.span.start)).unwrap_or_default();
    let tail = text.get(place(mutant.span.end)..).unwrap_or_default();
    format!("{head}{}{tail}", mutant.replacement)
}

#[cfg(test)]
mod tests {
    use super::super::list::{Genre, Place, Span};
    use super::*;

    #[test]
    fn the_span_is_replaced() {
        let place = |line, column| Place { line, column };
        let mutant = Mutant {
            name: String::new(),
            file: String::new(),
            genre: Genre::BinaryOperator,
            replacement: "*".to_owned(),
            span: Span { start: place(2, 3), end: place(2, 4) },
        };
        assert_eq!(changed("// µ\na + b\n", &mutant), "// µ\na * b\n");
    }
}
