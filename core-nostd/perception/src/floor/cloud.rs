//! The floor of a point cloud: how a sensor that scans the room is mounted, from one sweep of the floor around it.
//!
//! The same search and the same least squares as for a depth camera, but every return counts alike: a lidar errs by the
//! same centimetre near and far. Source: book, Floor and dirt: Floor of a point cloud.

use super::normal_equations::NormalEquations;
use super::plane::{Plane, dot};
use super::search::{Expectation, Samples, best, choose};
use floorguard_types::profile::{Host, List, Profile};
use floorguard_types::random::Pcg32;

/// A cloud is searched on a computer only.
type FloorSamples = <Host as Profile>::FloorSamples;

/// Half widths of the bands of the passes, metres: from the search's to three standard deviations of a range.
const BANDS_M: [f32; 6] = [0.06, 0.05, 0.04, 0.04, 0.04, 0.04];
/// Huber's threshold, metres: one and a half standard deviations of a range.
const HUBER_M: f32 = 0.02;
/// Fewest points in the last band.
const POINTS_MIN: u32 = 50;

/// The floor among points in the sensor's frame, whose axes are free; `expectation` says where up is. `seed` drives the
/// search. `None` where no plane fits or the expectation does not allow it.
///
/// The points are walked through several times, so the iterator must be cheap to clone.
#[must_use]
pub fn floor_of_points<I>(points: I, expectation: &Expectation, seed: u64) -> Option<Plane>
where
    I: Iterator<Item = [f32; 3]> + Clone,
{
    let mut random = Pcg32::new(seed, 0xC1);
    let finite = points.filter(|point| point.iter().all(|value| value.is_finite()));
    // Only what may be floor by the mounting is searched: a hall has more walls than floor.
    let margin_m = 0.1;
    let [low, high] = expectation.distance_range_m;
    let tilt = libm::sinf(expectation.tilt_max_rad);
    let may_be_floor = finite.filter(|point| {
        let (down_m, away_m) = (-dot(expectation.mounted.normal, *point), libm::sqrtf(dot(*point, *point)));
        (low - margin_m - tilt * away_m..=high + margin_m + tilt * away_m).contains(&down_m)
    });
    let mut samples = Samples::<FloorSamples>::EMPTY;
    choose::<FloorSamples>(&mut samples, may_be_floor.clone(), &mut random);
    let mut plane = best(&samples, expectation, &mut random)?;
    for band_m in BANDS_M {
        plane = pass(may_be_floor.clone(), &plane, band_m)?;
    }
    expectation.allows(&plane).then_some(plane)
}

fn pass(points: impl Iterator<Item = [f32; 3]>, plane: &Plane, band_m: f32) -> Option<Plane> {
    let [across, along] = plane.axes();
    let (mut system, mut count) = (NormalEquations::default(), 0_u32);
    for point in points {
        let height = plane.height_m(point);
        if height.abs() < band_m {
            let weight = HUBER_M / height.abs().max(HUBER_M);
            system.add(weight, [dot(across, point), dot(along, point), 1.0], -height);
            count = count.saturating_add(1);
        }
    }
    if count < POINTS_MIN {
        return None;
    }
    let [turn_x, turn_y, shift] = system.solve()?;
    let ([nx, ny, nz], [ax, ay, az], [lx, ly, lz]) = (plane.normal, across, along);
    let turned = |n: f32, a: f32, l: f32| n + turn_x * a + turn_y * l;
    let normal = [turned(nx, ax, lx), turned(ny, ay, ly), turned(nz, az, lz)];
    let length = libm::sqrtf(dot(normal, normal)).max(1.0e-6);
    Plane::new(normal, (plane.distance_m + shift) / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expectation() -> Expectation {
        let mounted = Plane::new([0.0, 0.0, 1.0], 1.6).unwrap();
        Expectation { mounted, tilt_max_rad: 0.174_533, distance_range_m: [1.4, 1.8] }
    }

    /// A tilted floor with a table above it, a wall and returns that are no numbers.
    #[test]
    fn a_tilted_floor_under_a_table_is_found() {
        let mut random = Pcg32::new(5, 5);
        let truth = Plane::new([0.1, -0.03, 0.995], 1.58).unwrap();
        let mut points = std::vec::Vec::new();
        for index in 0..6_000 {
            let (x, y) = (random.uniform_between(-5.0, 5.0), random.uniform_between(-5.0, 5.0));
            let [nx, ny, nz] = truth.normal;
            let noise = 0.01 * random.normal();
            let height = if index % 4 == 0 { 0.75 } else { 0.0 };
            let z = (height + noise - truth.distance_m - nx * x - ny * y) / nz;
            points.push(if index % 5 == 0 { [4.0, y, random.uniform_between(-1.5, 1.5)] } else { [x, y, z] });
        }
        points.push([f32::NAN, 0.0, 0.0]);
        let found = floor_of_points(points.iter().copied(), &expectation(), 1).unwrap();
        assert!(found.tilt_from_rad(&truth) < 0.002, "{found:?}");
        assert!((found.distance_m - truth.distance_m).abs() < 0.003, "{found:?}");
        assert_eq!(floor_of_points(points.iter().take(30).copied(), &expectation(), 1), None);
    }
}
