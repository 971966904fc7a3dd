//! People who went out of sight: whoever appears where one of them can have walked to is that person again.
//!
//! A crowd hides everybody for seconds at a time. A track that is given up keeps its identity here; a fresh track takes
//! it over at the moment it is confirmed. A wrong guess costs no more than a new identity would.

use heapless::Vec;

use super::track::Track;
use crate::capacities::TRACKS_MAX;
use crate::geometry::Point2;
use crate::time::{Age, Stamp};

/// People remembered; the one lost longest ago goes first.
const LOST_MAX: usize = TRACKS_MAX / 2;
/// Nobody is remembered longer, µs.
const REMEMBERED_US: u64 = 8_000_000;
/// Nobody is looked for farther away, metres.
const REACH_MAX_M: f32 = 4.0;

/// Those who were lost.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    lost: Vec<Track, LOST_MAX>,
}

impl Memory {
    pub(super) const fn new() -> Self {
        Self { lost: Vec::new() }
    }

    /// Keeps a track that is given up.
    pub(super) fn keep(&mut self, track: &Track) {
        if self.lost.is_full() {
            let oldest = self.lost.iter().map(|other| other.last_seen).min();
            let mut gone = false;
            self.lost.retain(|other| {
                let goes = !gone && Some(other.last_seen) == oldest;
                gone |= goes;
                !goes
            });
        }
        // There is room now.
        let _ = self.lost.push(*track);
    }

    /// Forgets who was lost too long ago.
    pub(super) fn forget(&mut self, now: Stamp) {
        self.lost.retain(|track| lost_for_s(track, now) * 1.0e6 < REMEMBERED_US as f32);
    }

    /// Who among the lost fits best to somebody at `place`; the less, the better, up to 1.
    pub(super) fn best(&self, seen: (Point2, Stamp), reach: [f32; 2]) -> Option<(f32, u32)> {
        best_of(self.lost.iter(), seen, reach)
    }

    /// Takes somebody out.
    pub(super) fn take(&mut self, id: u32) -> Option<Track> {
        let found = self.lost.iter().find(|track| track.id == id).copied();
        self.lost.retain(|track| track.id != id);
        found
    }
}

/// Share of what somebody can have walked since the last sighting that the way to `place` is; up to 1.
pub(super) fn best_of<'a>(
    tracks: impl Iterator<Item = &'a Track>,
    (place, now): (Point2, Stamp),
    [reach_m, reach_mps]: [f32; 2],
) -> Option<(f32, u32)> {
    let fits = tracks.map(|track| {
        let reach_m = (reach_m + reach_mps * lost_for_s(track, now)).clamp(0.1, REACH_MAX_M);
        (track.state.position.distance(place) / reach_m, track.id)
    });
    fits.filter(|(share, _)| *share <= 1.0).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Seconds since the last sighting.
fn lost_for_s(track: &Track, now: Stamp) -> f32 {
    match track.last_seen.age(now) {
        Age::Past(age_us) => age_us as f32 * 1.0e-6,
        Age::Future(_) => 0.0,
    }
}
