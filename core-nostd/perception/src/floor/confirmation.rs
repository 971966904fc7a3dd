//! An object is one when it is seen again: twice in three frames, at the same place of the map.
//!
//! A false object appears somewhere else in every frame. Source: book, Floor and dirt: Confirmation.

use super::objects::{FloorObject, FloorObjectsOf};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::profile::{List, ListOf, Native, Profile};

/// Frames that are remembered.
const FRAMES: usize = 3;
/// Frames that must have shown an object.
const SIGHTINGS_MIN: u8 = 2;
/// Two sightings this near are the same object, metres: two cells of 0.05 m.
const SAME_PLACE_M: f32 = 0.1;

/// An object with its place in the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfirmedObject {
    /// Middle of its footprint, in the map frame.
    pub centre_in_map: Point2,
    /// Frames of the last three that showed it, this one included.
    pub sightings: u8,
    /// The object as this frame shows it.
    pub object: FloorObject,
}

/// The places of the objects in the last frames.
#[derive(Clone, Debug, Default)]
pub struct ObjectMemoryOf<P: Profile> {
    frames: [ListOf<Point2, P::FloorObjects>; FRAMES],
}

/// A memory in that of the target.
pub type ObjectMemory = ObjectMemoryOf<Native>;

impl<P: Profile> ObjectMemoryOf<P> {
    /// Takes a frame's objects and returns those that are confirmed. `camera_in_map` is the camera's foot point with
    /// the view's forward direction as heading, at the stamp of the image.
    pub fn update(
        &mut self,
        found: &FloorObjectsOf<P>,
        camera_in_map: Pose2,
    ) -> ListOf<ConfirmedObject, P::FloorObjects> {
        self.frames.rotate_right(1);
        let mut places = ListOf::<Point2, P::FloorObjects>::EMPTY;
        let mut confirmed = ListOf::<ConfirmedObject, P::FloorObjects>::EMPTY;
        for object in found.objects.iter() {
            let ([lx, ly], [hx, hy]) = (object.low_m, object.high_m);
            // Robot frames have x forward and y left; footprints have right first, then forward.
            let place = camera_in_map.transform(Point2::new(0.5 * (ly + hy), -0.5 * (lx + hx)));
            let [_, before, earlier] = &self.frames;
            let was_there =
                |frame: &[Point2]| u8::from(frame.iter().any(|other| other.distance(place) < SAME_PLACE_M));
            let sightings = 1_u8.saturating_add(was_there(before)).saturating_add(was_there(earlier));
            // Both lists have the capacity of the frame's own list: a push cannot fail.
            let _ = places.push(place);
            if sightings >= SIGHTINGS_MIN {
                let _ = confirmed.push(ConfirmedObject { centre_in_map: place, sightings, object: *object });
            }
        }
        let [newest, ..] = &mut self.frames;
        *newest = places;
        confirmed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::FloorObjects;

    fn frame(forward_m: f32) -> FloorObjects {
        let mut objects = FloorObjects::default();
        let object =
            FloorObject { low_m: [-0.02, forward_m], high_m: [0.02, forward_m], ..FloorObject::default() };
        objects.objects.push(object).unwrap();
        objects
    }

    #[test]
    fn same_place_twice_in_three_frames_confirms() {
        let mut memory = ObjectMemory::default();
        let at = |x_m: f32| Pose2::new(x_m, 0.0, 0.0);
        assert!(memory.update(&frame(1.0), at(0.0)).is_empty());
        assert!(memory.update(&FloorObjects::default(), at(0.1)).is_empty());
        let confirmed = memory.update(&frame(0.8), at(0.2));
        assert_eq!(confirmed.len(), 1);
        assert!(confirmed[0].centre_in_map.distance(Point2::new(1.0, 0.0)) < 1e-5);
        assert!(memory.update(&frame(1.2), at(0.2)).is_empty());
    }
}
