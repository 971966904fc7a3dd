//! Units at the ends of keys: what a key is without its own, and which one a wrong value is in.

use std::ops::RangeInclusive;

/// Endings of keys that carry a unit.
const UNITS: [&str; 22] = [
    "_mps2", "_mps", "_kmh", "_radps", "_degps", "_deg", "_rad", "_mm", "_cm", "_km", "_m", "_us", "_ms",
    "_s", "_min", "_hz", "_khz", "_per_m", "_baud", "_kg", "_in", "_ft",
];

/// A key without its unit.
pub(super) fn stem(key: &str) -> &str {
    UNITS.iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key)
}

/// The usual wrong unit explains most values that are far out of range.
pub(super) fn unit_hint(key: &str, number: f32, range: &RangeInclusive<f32>) -> String {
    let candidates: &[(&str, f32)] = if key.ends_with("_m") || key.ends_with("_mps") || key.ends_with("_mps2")
    {
        &[("millimetres", 1.0e-3), ("centimetres", 1.0e-2)]
    } else if key.ends_with("_s") {
        &[("milliseconds", 1.0e-3)]
    } else if key.ends_with("_rad") {
        &[("degrees", core::f32::consts::PI / 180.0)]
    } else {
        &[]
    };
    let fitting = candidates.iter().find(|(_, factor)| number != 0.0 && range.contains(&(number * factor)));
    fitting.map_or("write a value within these limits".to_owned(), |(unit, factor)| {
        // Six digits: the factor must not show up as 0.90000004.
        format!("if {number} is meant in {unit}, write {}", (number * factor * 1.0e6).round() / 1.0e6)
    })
}
