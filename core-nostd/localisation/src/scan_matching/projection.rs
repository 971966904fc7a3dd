//! A scan onto another scan of the same scanner, to millimetres: each return is compared with the line through those of the other
//! scan that lie in its direction (projective point-to-line matching; Blais and Levine 1995, Censi 2008).
//!
//! No raster lies between: what a cell of one would round is what a robot that docks is wrong by.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{count_f32, saturating_usize};
use nalgebra::{Matrix3, Vector3};

/// Beams to either side of a direction through which its line goes.
const SIDE: usize = 3;
/// Neighbouring returns this much nearer or farther than a line through them would have it are no line, share of the range.
const BENT: f32 = 0.03;
/// A return farther from its line belongs to something else, metres; …
const OTHER_M: f32 = 0.15;
/// … from half of the way on it counts less: Huber's weight, metres.
const DOUBTED_M: f32 = 0.05;
/// Steps at most.
const STEPS: u8 = 20;
/// A step below this length (metres, radians) is the last one.
const STEP_LEAST: f32 = 1.0e-5;
/// Returns that must have a line.
const MATCHED_MIN: usize = 40;

/// What a scanner saw at a place: the mean ranges of its beams.
#[derive(Clone, Copy, Debug)]
pub struct Panorama<'a> {
    /// Metres; 0 where nothing was met.
    pub ranges_m: &'a [f32],
    /// Of the first beam, radians.
    pub first_angle_rad: f32,
    /// From beam to beam, radians.
    pub step_rad: f32,
}

/// Where it was seen from once more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// The scanner in the frame of the panorama's.
    pub pose: Pose2,
    /// Share of the returns that lie on a line.
    pub share: f32,
}

impl Panorama<'_> {
    /// The place of the scanner from which these returns (its own frame) lie on the lines of the panorama, from a guess on that is right
    /// within a decimetre. `None`: too few do. Cost: 20 × returns.
    #[must_use]
    pub fn locate(&self, returns: &[Point2], guess: Pose2) -> Option<Projected> {
        let mut pose = guess;
        let mut matched = 0;
        for _ in 0..STEPS {
            let (matrix, vector, count) = self.normal_equations(returns, pose);
            matched = count;
            if count < MATCHED_MIN {
                return None;
            }
            let floor = Matrix3::from_diagonal_element(1.0e-4);
            let step = -(matrix + floor).cholesky()?.solve(&vector);
            let [x_m, y_m, turn_rad] = [step.x, step.y, step.z];
            pose = Pose2::new(pose.x_m + x_m, pose.y_m + y_m, pose.heading_rad + turn_rad);
            if step.norm() < STEP_LEAST {
                break;
            }
        }
        Some(Projected { pose, share: count_f32(matched) / count_f32(returns.len()).max(1.0) })
    }

    /// Of one step: the curvature, the slope, and how many returns have a line.
    fn normal_equations(&self, returns: &[Point2], pose: Pose2) -> (Matrix3<f32>, Vector3<f32>, usize) {
        let (mut matrix, mut vector, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0_usize);
        for seen in returns {
            let place = pose.transform(*seen);
            let Some((on_line, normal)) = self.line_at(place) else { continue };
            let off_m = normal.x_m * (place.x_m - on_line.x_m) + normal.y_m * (place.y_m - on_line.y_m);
            if libm::fabsf(off_m) > OTHER_M {
                continue;
            }
            count = count.saturating_add(1);
            let weight = if libm::fabsf(off_m) > DOUBTED_M { DOUBTED_M / libm::fabsf(off_m) } else { 1.0 };
            let arm = Point2::new(place.x_m - pose.x_m, place.y_m - pose.y_m);
            let slope = Vector3::new(normal.x_m, normal.y_m, normal.y_m * arm.x_m - normal.x_m * arm.y_m);
            matrix += slope * slope.transpose() * weight;
            vector += slope * (weight * off_m);
        }
        (matrix, vector, count)
    }

    /// The line of the panorama in the direction of a place: a point on it and its normal.
    fn line_at(&self, place: Point2) -> Option<(Point2, Point2)> {
        let angle_rad = libm::atan2f(place.y_m, place.x_m);
        let beam = libm::roundf((angle_rad - self.first_angle_rad) / self.step_rad.max(1.0e-6));
        if beam < 0.0 {
            return None;
        }
        let middle = saturating_usize(beam);
        let first = middle.checked_sub(SIDE)?;
        let last = middle.checked_add(SIDE)?;
        let (from, to) = (self.end_of(first)?, self.end_of(last)?);
        let along = Point2::new(to.x_m - from.x_m, to.y_m - from.y_m);
        let length_m = along.norm();
        if length_m < 1.0e-3 {
            return None;
        }
        let normal = Point2::new(-along.y_m / length_m, along.x_m / length_m);
        // The mean of all of them, which lie on one line.
        let (mut mean, mut count) = (Point2::new(0.0, 0.0), 0.0);
        let limit_m = BENT * place.norm();
        for offset in 0..=2 * SIDE {
            let end = self.end_of(first.saturating_add(offset))?;
            let off_m = normal.x_m * (end.x_m - from.x_m) + normal.y_m * (end.y_m - from.y_m);
            if libm::fabsf(off_m) > limit_m {
                return None;
            }
            mean = Point2::new(mean.x_m + end.x_m, mean.y_m + end.y_m);
            count += 1.0;
        }
        Some((Point2::new(mean.x_m / count, mean.y_m / count), normal))
    }

    /// Where a beam ended; `None` where nothing was met, or there is no such beam.
    fn end_of(&self, beam: usize) -> Option<Point2> {
        let range_m = self.ranges_m.get(beam).copied().filter(|range_m| *range_m > 0.0)?;
        let (sin, cos) = libm::sincosf(self.first_angle_rad + count_f32(beam) * self.step_rad);
        Some(Point2::new(range_m * cos, range_m * sin))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;
    use std::vec::Vec;

    const FIRST_RAD: f32 = -2.356;
    const STEP_RAD: f32 = 0.008_727;

    /// Ranges in a hall of 9 by 7 m with a cupboard, seen from a place in it.
    fn ranges(scanner: Pose2) -> Vec<f32> {
        let range = |beam: u16| {
            let (sin, cos) = libm::sincosf(scanner.heading_rad + FIRST_RAD + f32::from(beam) * STEP_RAD);
            let to = |at: f32, from: f32, along: f32| {
                if along.abs() < 1.0e-6 { 99.0 } else { (at - from) / along }
            };
            let (x, y) = (scanner.x_m, scanner.y_m);
            let walls = [to(9.0, x, cos), to(0.0, x, cos), to(7.0, y, sin), to(0.0, y, sin)];
            let wall_m = walls.into_iter().filter(|range| *range > 0.0).fold(99.0, f32::min);
            let cupboard_m = to(5.0, x, cos);
            let is_met = cupboard_m > 0.0 && (3.0..4.0).contains(&(y + cupboard_m * sin));
            if is_met { wall_m.min(cupboard_m) } else { wall_m }
        };
        (0..541).map(range).collect()
    }

    fn noisy(ranges: &[f32], deviation_m: f32, random: &mut Pcg32) -> Vec<f32> {
        ranges.iter().map(|range| range + deviation_m * random.normal()).collect()
    }

    fn ends(ranges: &[f32]) -> Vec<Point2> {
        let end = |(beam, range): (usize, &f32)| {
            let (sin, cos) = libm::sincosf(FIRST_RAD + beam as f32 * STEP_RAD);
            Point2::new(range * cos, range * sin)
        };
        ranges.iter().enumerate().map(end).collect()
    }

    /// Wherever the walls lie to the axes: no place is preferred.
    #[test]
    fn place_is_known_to_millimetres() {
        let mut random = Pcg32::new(5, 1);
        for turn in [0.0, 0.013, 0.4] {
            let dock = Pose2::new(2.9, 1.5, turn);
            let mean = noisy(&ranges(dock), 0.005, &mut random);
            let panorama = Panorama { ranges_m: &mean, first_angle_rad: FIRST_RAD, step_rad: STEP_RAD };
            for (x_m, y_m, heading_rad) in
                [(0.0, 0.0, 0.0), (-0.05, 0.004, 0.01), (-0.4, 0.03, -0.05), (-0.9, -0.1, 0.1)]
            {
                let truth = Pose2::new(x_m, y_m, heading_rad);
                let (mut off, scans) = ([0.0, 0.0, 0.0], 10.0);
                for _ in 0..10 {
                    let seen = noisy(&ranges(dock.compose(truth)), 0.03, &mut random);
                    let guess = Pose2::new(x_m + 0.03, y_m - 0.03, heading_rad + 0.02);
                    let found = panorama.locate(&ends(&seen), guess).expect("a place");
                    assert!(found.share > 0.6, "{found:?}");
                    off[0] += (found.pose.x_m - x_m) / scans;
                    off[1] += (found.pose.y_m - y_m) / scans;
                    off[2] += (found.pose.heading_rad - heading_rad) / scans;
                }
                let [x, y, heading] = off.map(f32::abs);
                assert!(x < 0.003 && y < 0.003 && heading < 0.001, "{truth:?} in {dock:?}: {off:?}");
            }
        }
    }

    /// Somebody before the scanner moves nothing.
    #[test]
    fn what_has_changed_counts_little() {
        let dock = Pose2::new(2.9, 1.5, 0.0);
        let mean = ranges(dock);
        let panorama = Panorama { ranges_m: &mean, first_angle_rad: FIRST_RAD, step_rad: STEP_RAD };
        let mut seen = ranges(dock);
        seen[250..290].fill(1.2);
        let found = panorama.locate(&ends(&seen), Pose2::new(0.03, 0.02, 0.01)).expect("a place");
        let off_m = libm::hypotf(found.pose.x_m, found.pose.y_m);
        assert!(off_m < 0.003 && found.pose.heading_rad.abs() < 0.001 && found.share < 0.95, "{found:?}");
    }

    #[test]
    fn nothing_in_sight_gives_no_place() {
        let mean = [0.0; 541];
        let panorama = Panorama { ranges_m: &mean, first_angle_rad: FIRST_RAD, step_rad: STEP_RAD };
        let seen = ends(&ranges(Pose2::new(2.9, 1.5, 0.0)));
        assert_eq!(panorama.locate(&seen, Pose2::default()), None);
        assert_eq!(panorama.locate(&[], Pose2::default()), None);
    }
}
