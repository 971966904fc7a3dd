//! Colours that stay apart for colour-blind readers and in print (after Okabe and Ito).

pub(super) const PAPER: &str = "#ffffff";
pub(super) const FLOOR: &str = "#f6f7f9";
pub(super) const GRID: &str = "#e3e7ec";
pub(super) const WALL: &str = "#39424e";
pub(super) const OBSTACLE: &str = "#cdd3db";
pub(super) const OBSTACLE_EDGE: &str = "#8d97a5";
pub(super) const INK: &str = "#1d242d";
pub(super) const FAINT: &str = "#66707d";
pub(super) const ROBOT: &str = "#0a5fb4";

const PEOPLE: [&str; 6] = ["#009e73", "#b8860b", "#56a4d8", "#a86b98", "#6b8e23", "#7a6f5d"];
const CAUSES: [&str; 6] = ["#c8321f", "#e08a00", "#7b2d8b", "#a3195b", "#5d4037", "#37474f"];

/// Colour of the person at this place of the list.
pub(super) fn person(index: usize) -> &'static str {
    PEOPLE[index % PEOPLE.len()]
}

/// Colour of the cause at this place of the list.
pub(super) fn cause(index: usize) -> &'static str {
    CAUSES[index % CAUSES.len()]
}
