//! Tests of the guard. Names carry the requirement that they check: `fg_req_012_…`.

mod bit_flips;
mod bits;
mod boundaries;
mod checks;
mod closed_way;
mod collisions;
mod configurations;
mod contents;
mod exploration;
mod fastest_point;
pub(crate) mod fixtures;
mod latches;
mod memory;
mod numbers;
mod oracles;
mod properties;
mod reachable;
mod rear;
mod reset_answers;
mod selection;
mod starts;
mod tables;
mod timelines;
mod truth_tables;
mod unseen;
mod vectors;
