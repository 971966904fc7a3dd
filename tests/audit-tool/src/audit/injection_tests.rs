//! Real files of the guard and the drivers, each corrupted by one mistake: the audit must fail and name the
//! line.
//!
//! The unmodified file is audited first, so that each test sees the verdict turn.

use crate::audit::run::judge_sources;
use crate::claim::Claim;
use crate::sources::SourceFile;
use crate::{shell, sources};

const GUARD: &str = "core-nostd/guard/src/supervisor.rs";
const TABLE: &str = "core-nostd/guard/src/protection/packet_table.rs";

fn parsed(path: &str, text: String) -> SourceFile {
    sources::parse(path, text).expect("the file parses")
}

/// Claims that fail, with the lines they name.
fn failing(file: SourceFile) -> Vec<(&'static str, usize)> {
    let (claims, _) = judge_sources(&[file]);
    let named = |claim: &Claim| claim.findings.iter().map(|f| (claim.id, f.line)).collect::<Vec<_>>();
    claims.iter().flat_map(named).collect()
}

/// Puts `mistake` for `original` in a file of the tree; the audit must then name its line under `claim`, and nothing
/// else.
fn corrupt(path: &str, (original, mistake): (&str, &str), claim: &str) {
    let text = std::fs::read_to_string(shell::root().join(path)).expect("the file is there");
    assert_eq!(failing(parsed(path, text.clone())), [], "the unmodified file must hold");
    assert_eq!(text.matches(original).count(), 1, "`{original}` must stand once in {path}");
    let line = text.split(original).next().map_or(0, |before| before.matches('\n').count() + 1);
    let found = failing(parsed(path, text.replace(original, mistake)));
    assert_eq!(found, [(claim, line)], "`{mistake}` in {path}");
}

#[test]
fn a_deleted_bound_is_named() {
    corrupt(TABLE, ("for sample in 0..SAMPLES {", "for sample in 0.. {"), "loops-bounded");
    corrupt(
        TABLE,
        ("for sample in 0..SAMPLES {", "for sample in 0..first_cdeg * 2 + sets {"),
        "loops-bounded",
    );
}

#[test]
fn a_while_on_a_sensor_value_is_named() {
    let first = "        let silent = silent_cdeg(packet);";
    let waiting = "        let silent = silent_cdeg(packet); while packet.columns.is_empty() {}";
    corrupt(GUARD, (first, waiting), "loops-bounded");
}

#[test]
fn a_vec_is_named() {
    let first = "        let mut accepted = false;";
    corrupt(GUARD, (first, "        let mut accepted = false; let v: Vec<u8> = f();"), "no-heap-in-sources");
    corrupt(GUARD, (first, "        let mut accepted = false; let v = vec![1];"), "no-heap-in-sources");
}

#[test]
fn an_unwrap_is_named() {
    let original = "self.state.monitors.get_mut(source.index())";
    corrupt(
        GUARD,
        (original, "Some(self.state.monitors.get_mut(source.index()).unwrap())"),
        "no-panic-in-sources",
    );
}

#[test]
fn a_recursion_is_named() {
    let original = "        self.state.machine.request_reset(now);";
    corrupt(GUARD, (original, "        self.request_reset(now);"), "no-recursion-in-sources");
    corrupt(GUARD, (original, "        Supervisor::request_reset(self, now);"), "no-recursion-in-sources");
}

#[test]
fn unsafe_code_is_named() {
    let original = "        self.state.machine.request_reset(now);";
    corrupt(GUARD, (original, "        unsafe { self.state.machine.request_reset(now) };"), "no-unsafe");
}

#[test]
fn a_call_through_a_pointer_is_named() {
    let original = "        self.state.machine.request_reset(now);";
    corrupt(GUARD, (original, "        let call: fn(Stamp) = later; call(now);"), "no-pointers");
}

/// The tree as it stands: what the tests above break holds before.
#[test]
fn the_sources_of_the_tree_hold() {
    let files = sources::read_audited(&shell::root()).expect("the layers can be read");
    let (claims, _) = judge_sources(&files);
    let findings = claims.iter().flat_map(|claim| &claim.findings).collect::<Vec<_>>();
    assert!(findings.is_empty(), "{findings:#?}");
}

#[test]
fn crate_without_compiler_refusals_is_named() {
    for library in sources::crates().iter().map(|one| format!("{}/src/lib.rs", one.folder)) {
        for (attribute, claim) in
            [("#![forbid(unsafe_code)]", "no-unsafe"), ("#![no_std]", "no-heap-in-sources")]
        {
            let text = std::fs::read_to_string(shell::root().join(&library)).expect("the file is there");
            assert_eq!(failing(parsed(&library, text.clone())), []);
            assert_eq!(failing(parsed(&library, text.replace(attribute, ""))), [(claim, 1)], "{library}");
        }
    }
}
