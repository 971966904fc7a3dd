//! Believes in a moving object after several sweeps and forgets it after several: confidence tracking. Source: book,
//! Motion: Confidence.
//!
//! The source keeps the results of ζ sweeps and the correspondences between them; one run length per object carries
//! the same information. The reported centroids are kept in the frame of the odometry, so the robot's own motion needs
//! no correction here.

use super::correspondence::{MotionObject, nearest, squared};
use super::parameters::MotionParameters;
use floorguard_types::geometry::Point3;
use floorguard_types::number::truncating_u16;
use floorguard_types::profile::{List, ListOf, Profile};

/// Sweeps for which a moving object stays confirmed while it is not observable whether it still moves: a person who
/// passes behind a pillar or another person.
const HELD_MAX: u8 = 10;

/// A moving object that is believed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingObject {
    /// Where it was seen last, in the frame of the odometry.
    pub centroid: Point3,
    /// Sweeps at rest, less those in motion (β).
    pub rest: u8,
    /// Index of what was seen of it in the newest sweep (a part, or an object of the published steps); `None` if
    /// nothing near it changed.
    pub object: Option<u16>,
    /// Sweeps since it was last seen to change, without having been seen at rest.
    held: u8,
    /// Returns around it that the moment before says nothing about: their number and sum. Of the newest sweep.
    unknown: (u16, [f32; 3]),
    /// Something hides the place.
    hidden: bool,
}

impl MovingObject {
    /// An object that has just been found moving.
    const fn new(centroid: Point3, object: u16) -> Self {
        let unknown = (0, [0.0; 3]);
        Self { centroid, rest: 0, object: Some(object), held: 0, unknown, hidden: false }
    }
}

/// Run lengths and the set of moving objects.
#[derive(Clone, Debug)]
pub(super) struct Confidence<P: Profile> {
    runs: ListOf<u8, P::MotionObjects>,
    pub(super) moving: ListOf<MovingObject, P::MotionTracked>,
    /// Moving objects beyond the capacity.
    pub(super) dropped: u32,
}

impl<P: Profile> Confidence<P> {
    pub(super) const fn new() -> Self {
        Self { runs: List::EMPTY, moving: List::EMPTY, dropped: 0 }
    }

    /// A gap or a jump: what is known of the past no longer belongs to what comes. Moving objects age by one
    /// sweep.
    pub(super) fn break_chains(&mut self, parameters: &MotionParameters) {
        self.runs.clear();
        for moving in self.moving.iter_mut() {
            moving.rest = moving.rest.saturating_add(1);
            moving.object = None;
        }
        self.moving.retain(|moving| moving.rest <= parameters.rest_max);
    }

    /// Before the returns of a sweep: which places are hidden now.
    pub(super) fn begin(&mut self, is_hidden: impl Fn(Point3) -> bool) {
        for moving in self.moving.iter_mut() {
            moving.unknown = (0, [0.0; 3]);
            moving.hidden = is_hidden(moving.centroid);
        }
    }

    /// A return about which the moment before says nothing belongs to the moving objects around it.
    pub(super) fn note_unknown(&mut self, point: Point3, parameters: &MotionParameters) {
        let near_m = parameters.leave_off_m;
        for moving in self.moving.iter_mut() {
            let (dx, dy) = (moving.centroid.x_m - point.x_m, moving.centroid.y_m - point.y_m);
            if dx * dx + dy * dy <= near_m * near_m {
                let (count, [x, y, z]) = moving.unknown;
                moving.unknown = (count.saturating_add(1), [x + point.x_m, y + point.y_m, z + point.z_m]);
            }
        }
    }

    /// Takes in the results of a sweep: per object, whether it changed and its predecessor.
    pub(super) fn update(
        &mut self,
        objects: &[MotionObject],
        changed: &[bool],
        predecessors: &[Option<u16>],
        parameters: &MotionParameters,
    ) {
        for moving in self.moving.iter_mut() {
            moving.observe(objects, changed, parameters);
        }
        self.moving.retain(|moving| moving.rest <= parameters.rest_max);
        self.merge(parameters);
        let mut runs = ListOf::<u8, P::MotionObjects>::EMPTY;
        for (changed, predecessor) in changed.iter().zip(predecessors) {
            let before = predecessor.and_then(|index| self.runs.get(usize::from(index))).copied();
            let run = if *changed { before.unwrap_or(0).saturating_add(1) } else { 0 };
            // Same capacity as the list of objects: never full.
            let _ = runs.push(run);
        }
        self.runs = runs;
        for (index, object) in objects.iter().enumerate().take(self.runs.len()) {
            if self.runs.get(index).is_some_and(|run| *run >= parameters.chain) {
                self.believe(index, object.centroid, parameters);
            }
        }
    }

    /// Two that met and are no longer distinguishable are one: the one that has rested less, the first of equals.
    fn merge(&mut self, parameters: &MotionParameters) {
        let catch_up2 = parameters.catch_up_m * parameters.catch_up_m;
        let all = self.moving.clone();
        let mut index = 0_usize;
        self.moving.retain(|moving| {
            let own = index;
            index += 1;
            !all.iter().enumerate().any(|(other, rival)| {
                let better = (rival.rest, other) < (moving.rest, own);
                better && squared(rival.centroid, moving.centroid) <= catch_up2
            })
        });
    }

    /// Enters an object at the end of a chain, or moves the one that it is.
    fn believe(&mut self, index: usize, centroid: Point3, parameters: &MotionParameters) {
        let mut best: Option<(&mut MovingObject, f32)> = None;
        for moving in self.moving.iter_mut() {
            let distance2 = squared(moving.centroid, centroid);
            if best.as_ref().is_none_or(|(_, least2)| distance2 < *least2) {
                best = Some((moving, distance2));
            }
        }
        let catch_up2 = parameters.catch_up_m * parameters.catch_up_m;
        if let Some((moving, _)) = best.filter(|(_, distance2)| *distance2 <= catch_up2) {
            (moving.centroid, moving.object) = (centroid, Some(truncating_u16(index)));
            return;
        }
        let fresh = MovingObject::new(centroid, truncating_u16(index));
        if self.moving.push(fresh).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// A moving object was last seen here.
    pub(super) fn is_near(&self, centroid: Point3, parameters: &MotionParameters) -> bool {
        let leave_off2 = parameters.leave_off_m * parameters.leave_off_m;
        self.moving.iter().any(|moving| squared(moving.centroid, centroid) <= leave_off2)
    }
}

impl MovingObject {
    /// Nothing near it changed. It rests, unless that is not observable for a while: unknown is not at rest
    /// (own).
    fn hold(&mut self, parameters: &MotionParameters) {
        self.object = None;
        let (count, [x, y, z]) = self.unknown;
        let is_unknown = count >= parameters.points_min;
        if self.held >= HELD_MAX || !(is_unknown || self.hidden) {
            self.rest = self.rest.saturating_add(1);
            return;
        }
        self.held = self.held.saturating_add(1);
        if is_unknown {
            let share = 1.0 / f32::from(count.max(1));
            self.centroid = Point3::new(x * share, y * share, z * share);
        }
    }

    /// Policies 1 to 3 with the nearest object.
    fn observe(&mut self, objects: &[MotionObject], changed: &[bool], parameters: &MotionParameters) {
        let leave_off2 = parameters.leave_off_m * parameters.leave_off_m;
        let near = nearest(objects, self.centroid).filter(|(_, distance2)| *distance2 <= leave_off2);
        let Some((index, _)) = near else {
            self.hold(parameters);
            return;
        };
        self.held = 0;
        self.rest = if changed.get(index).copied().unwrap_or(false) {
            self.rest.saturating_sub(1)
        } else {
            self.rest.saturating_add(1)
        };
        self.object = Some(truncating_u16(index));
        if let Some(object) = objects.get(index) {
            self.centroid = object.centroid;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the book, Motion: Confidence: one object, ζ = 4, β_max = 3.
    #[test]
    fn published_sequence_is_reported_from_5_to_10() {
        let parameters = MotionParameters::PAPER;
        let results = [0, 1, 1, 1, 1, 0, 0, 1, 0, 0, 0, 0];
        // The example counts frames from 1.
        let mut confidence = Confidence::<floorguard_types::profile::Native>::new();
        let mut reported = std::vec::Vec::new();
        let mut rests = std::vec::Vec::new();
        for (frame, result) in results.into_iter().enumerate() {
            let object = MotionObject {
                centroid: Point3::new(frame as f32 * 0.1, 0.0, 0.0),
                volume_m3: 0.3,
                points: 100,
            };
            confidence.update(&[object], &[result == 1], &[(frame > 0).then_some(0)], &parameters);
            reported.push(confidence.moving.iter().any(|moving| moving.object == Some(0)));
            rests.push(confidence.moving.first().map(|moving| moving.rest));
        }
        let (no, yes) = (false, true);
        assert_eq!(reported, [no, no, no, no, yes, yes, yes, yes, yes, yes, no, no]);
        assert_eq!(rests[4..11], [Some(0), Some(1), Some(2), Some(1), Some(2), Some(3), None]);
    }
}
