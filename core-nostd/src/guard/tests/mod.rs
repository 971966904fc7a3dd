//! Tests of the guard. Names carry the requirement that they check: `fg_req_012_…`.

mod bit_flips;
mod bits;
mod boundaries;
mod exploration;
mod fixtures;
mod numbers;
mod properties;
mod reachable;
mod selection;
mod timelines;
mod truth_tables;
mod vectors;
