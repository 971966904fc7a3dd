//! The tasks that run the audited code on a robot: they make drive commands of decisions, and belong to no audited crate. What their
//! sources alone prove is one claim; no image holds them, because their executor calls through registers.

use std::path::Path;

use anyhow::Result;

use crate::claim::Claim;
use crate::facts::facts;
use crate::forbidden::{self, Forbidden};
use crate::loops;
use crate::sources::{self, SourceFile};

/// All sources of the tasks.
pub fn read(root: &Path) -> Result<Vec<SourceFile>> {
    sources::read_folders(root, &facts().sources.tasks)
}

/// What they must not contain, and loops that neither end nor wait.
pub fn judge(files: &[SourceFile]) -> Claim {
    let (mut found, mut sites, mut findings) = (Forbidden::default(), 0, vec![]);
    for file in files {
        forbidden::inspect(file, &mut found);
        let (listed, unbounded) = loops::list(file);
        sites += listed.len();
        // The `for` of an implementation that a macro writes is no loop.
        let line = |number: usize| file.text.lines().nth(number.saturating_sub(1)).unwrap_or_default().trim();
        findings.extend(unbounded.into_iter().filter(|finding| {
            let is_of_a_macro = finding.message.starts_with("`for` inside a macro");
            !(is_of_a_macro && line(finding.line).starts_with("impl "))
        }));
    }
    // Methods of a trait that hand over to those of the type by the same names look like circles, and are not searched for them.
    let Forbidden { unsafe_code, heap, panics, .. } = found;
    findings.extend([unsafe_code, heap, panics].concat());
    Claim {
        id: "tasks-in-sources",
        text: "The tasks around core and drivers name nothing that allocates, panics or is unsafe, and each loop of theirs ends or waits.",
        evidence: format!("{sites} loops and iterator chains listed; {} files read as syntax", files.len()),
        findings,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell;

    const ORDER: &str = "runtime/src/tasks/drive_order.rs";

    #[test]
    fn tasks_of_the_tree_hold() {
        let files = read(&shell::root()).expect("the tasks can be read");
        assert!(files.iter().any(|file| file.path == ORDER), "the file that makes commands of decisions");
        let findings = judge(&files).findings;
        assert!(findings.is_empty(), "{findings:#?}");
    }

    /// One mistake after another in the file that makes commands of decisions.
    #[test]
    fn mistake_in_a_task_is_named() {
        let text = std::fs::read_to_string(shell::root().join(ORDER)).expect("the file is there");
        let original = "        let permitted = order.permitted;";
        assert_eq!(text.matches(original).count(), 1);
        let line = text.split(original).next().map_or(0, |before| before.matches('\n').count() + 1);
        for mistake in [
            "let permitted = self.order.get().unwrap().permitted;",
            "let permitted = TABLE[order.index];",
            "let permitted = order.permitted; let kept = Box::new(permitted);",
            "let permitted = unsafe { *pointer };",
            "let permitted = order.permitted; while permitted.is_finite() {}",
            "let permitted = order.permitted; loop {}",
        ] {
            let text = text.replace(original, mistake);
            let file = sources::parse(ORDER, text).expect("the file parses");
            let lines: Vec<usize> = judge(&[file]).findings.iter().map(|finding| finding.line).collect();
            assert!(!lines.is_empty() && lines.iter().all(|found| *found == line), "`{mistake}`: {lines:?}");
        }
    }
}
