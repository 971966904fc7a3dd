//! A recorded walk: somebody who really walked this path at these times.

use floorguard_types::geometry::Point2;

/// Where a person was, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedWalk {
    /// World time in microseconds, and the place in the world frame; times rise.
    pub places: Vec<(u64, Point2)>,
}

impl RecordedWalk {
    /// Place and velocity at a time; `None` before the first and after the last moment: nobody knows where.
    #[must_use]
    pub fn at(&self, now_us: u64) -> Option<(Point2, Point2)> {
        let next = self.places.partition_point(|(at_us, _)| *at_us <= now_us);
        let (from_us, from) = *self.places.get(next.checked_sub(1)?)?;
        let (to_us, to) = *self.places.get(next)?;
        let lasts_s = (to_us - from_us) as f32 * 1.0e-6;
        let part = (now_us - from_us) as f32 * 1.0e-6 / lasts_s;
        let offset = Point2::new(to.x_m - from.x_m, to.y_m - from.y_m);
        let place = Point2::new(from.x_m + part * offset.x_m, from.y_m + part * offset.y_m);
        Some((place, Point2::new(offset.x_m / lasts_s, offset.y_m / lasts_s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walk_is_straight_between_samples_empty_outside() {
        let places = vec![(1_000_000, Point2::new(0.0, 0.0)), (1_400_000, Point2::new(0.4, -0.2))];
        let walk = RecordedWalk { places };
        let (place, velocity) = walk.at(1_200_000).unwrap();
        assert!(place.distance(Point2::new(0.2, -0.1)) < 1e-6);
        assert!(velocity.distance(Point2::new(1.0, -0.5)) < 1e-5);
        assert_eq!((walk.at(999_999), walk.at(1_400_000)), (None, None));
        assert_eq!(RecordedWalk::default().at(5), None);
    }
}
