//! Writes what was learnt as a source file of the core.

use std::fmt::Write as _;

use floorguard_perception::legs::Stump;
use floorguard_perception::people::person_model::Tree;

use super::boosting::Forest;

/// The file `person_table.rs`; `provenance` says in comment lines how it was trained.
#[must_use]
pub fn person_table(forest: &Forest, provenance: &[String]) -> String {
    let mut text = String::from(
        "//! The trees of the person classifier. Written by `floorguard train people`; not edited by hand.\n//!\n",
    );
    for line in provenance {
        let _ = writeln!(text, "//! {line}");
    }
    let _ = writeln!(text, "\nuse super::person_model::Tree;\n");
    let _ = writeln!(text, "/// Log-odds before any tree.\npub const OFFSET: f32 = {:?};\n", forest.offset);
    let _ = writeln!(
        text,
        "/// The trees.\n#[rustfmt::skip]\npub static TREES: [Tree; {}] = [",
        forest.trees.len()
    );
    for Tree { features, thresholds, leaves } in &forest.trees {
        let _ = writeln!(
            text,
            "    Tree {{ features: {features:?}, thresholds: [{}], leaves: {leaves:?} }},",
            thresholds.map(threshold).join(", ")
        );
    }
    text.push_str("];\n");
    text
}

/// The file `leg_table.rs`: committees for a known map, for none, both once more for known places, and for a scanner near
/// the floor.
#[must_use]
pub fn leg_table(committees: [&[Stump]; 5], provenance: &[String]) -> String {
    let mut text = String::from(
        "//! The committees of the leg detector. Written by `floorguard train legs`; not edited by hand.\n//!\n",
    );
    for line in provenance {
        let _ = writeln!(text, "//! {line}");
    }
    let _ = writeln!(text, "\nuse super::stumps::Stump;");
    let names = [
        ("WITH_MAP", "for segments that no map explains"),
        ("WITHOUT_MAP", "for all segments, without a map"),
        ("WITH_MAP_AND_PLACES", "for segments that no map explains, at places that earlier scans showed"),
        ("WITH_PLACES", "for all segments, at places that earlier scans showed"),
        ("NEAR_FLOOR", "for a coarse scanner near the floor, without a map"),
    ];
    for ((name, what), stumps) in names.into_iter().zip(committees) {
        let _ = writeln!(text, "\n/// The committee {what}.\n#[rustfmt::skip]");
        let _ = writeln!(text, "pub static {name}: [Stump; {}] = [", stumps.len());
        for pair in stumps.chunks(2) {
            let pair: Vec<String> = pair.iter().map(stump).collect();
            let _ = writeln!(text, "    {},", pair.join(", "));
        }
        text.push_str("];\n");
    }
    text
}

fn stump(Stump { feature, threshold, vote }: &Stump) -> String {
    format!("Stump {{ feature: {feature}, threshold: {}, vote: {vote:?} }}", self::threshold(*threshold))
}

fn threshold(value: f32) -> String {
    match value {
        f32::MAX => "f32::MAX".to_owned(),
        f32::MIN => "f32::MIN".to_owned(),
        _ => format!("{value:?}"),
    }
}
