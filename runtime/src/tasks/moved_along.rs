//! What a person pushes or pulls: a trolley, a chair, a suitcase. It has not the shape of a person, and the tracker takes it for something
//! that stands until it has gone far; but it moves as its person does (FG-REQ-087).

use floorguard_perception::people::Track;
use floorguard_types::time::{Age, Stamp};

/// The middle of what is pushed is no farther from the middle of its person, metres: the arms, and half of a trolley of 0.85 m.
const REACH_M: f32 = 1.2;
/// Slower it may stand, m/s: tracks of what stands move by some 0.05 m/s.
const MOVES_MPS: f32 = 0.1;
/// Its velocity differs by at most this from that of the person, m/s, and by this share of the person's speed: in a turn what is pushed
/// swings.
const DIFFERS: (f32, f32) = (0.05, 0.3);
/// A track that was not seen for longer than two sweeps says nothing of what moves now, microseconds.
const FRESH_US: u64 = 200_000;

/// A track moves along with a person: near the person, and as fast in the same direction, and both were seen lately.
pub fn moves_along(track: &Track, person: &Track, now: Stamp) -> bool {
    let is_fresh = |seen: &Track| match seen.last_seen.age(now) {
        Age::Past(age_us) => age_us <= FRESH_US,
        Age::Future(_) => true,
    };
    let (least_mps, share) = DIFFERS;
    let (speed_mps, person_mps) = (track.state.speed_mps(), person.state.speed_mps());
    is_fresh(track)
        && is_fresh(person)
        && speed_mps.min(person_mps) >= MOVES_MPS
        && track.state.position.distance(person.state.position) <= REACH_M
        && track.state.velocity.distance(person.state.velocity) <= least_mps + share * person_mps
}
