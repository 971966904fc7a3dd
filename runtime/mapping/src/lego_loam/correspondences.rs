//! Edges against lines, flats against planes of the sweep before.

use nalgebra::Vector3;

use super::features::Feature;
use super::motion::SweepStep;

/// Neighbours of a correspondence are on rows at most this far away.
const ROWS: i32 = 2;
/// A row of the equations: derivative by turn and by step, distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distance {
    /// Derivative by a turn of the motion.
    pub(super) turn: Vector3<f64>,
    /// By a step.
    pub(super) step: Vector3<f64>,
    /// Metres.
    pub(super) distance_m: f64,
    /// 0 to 1.
    pub(super) weight: f64,
}

/// Indices of the points that a feature was matched with.
pub(super) type Line = Option<[usize; 2]>;
pub(super) type Triangle = Option<[usize; 3]>;

/// The nearest so far.
#[derive(Clone, Copy)]
struct Nearest {
    index: Option<usize>,
    square_m2: f32,
}

impl Nearest {
    fn within(square_m2: f32) -> Self {
        Self { index: None, square_m2 }
    }

    fn offer(&mut self, index: usize, square_m2: f32) {
        if square_m2 < self.square_m2 {
            *self = Self { index: Some(index), square_m2 };
        }
    }
}

fn nearest(point: &Vector3<f32>, of: &[Feature], within_m2: f32) -> Option<usize> {
    let mut nearest = Nearest::within(within_m2);
    for (index, other) in of.iter().enumerate() {
        nearest.offer(index, (other.point - point).norm_squared());
    }
    nearest.index
}

/// The nearest point, and the nearest one on another row.
pub(super) fn line(feature: &Feature, step: SweepStep, last: &[Feature], within_m2: f32) -> Line {
    let [_, point] = step.to_start(feature);
    let point = point.map(|value| value as f32);
    let first = nearest(&point, last, within_m2)?;
    let row = i32::from(last[first].row);
    let mut second = Nearest::within(within_m2);
    for (index, other) in last.iter().enumerate() {
        let away = (i32::from(other.row) - row).abs();
        if away != 0 && away <= ROWS {
            second.offer(index, (other.point - point).norm_squared());
        }
    }
    Some([first, second.index?])
}

/// The nearest point, the next one on its row, and the nearest one on another row.
pub(super) fn triangle(feature: &Feature, step: SweepStep, last: &[Feature], within_m2: f32) -> Triangle {
    let [_, point] = step.to_start(feature);
    let point = point.map(|value| value as f32);
    let first = nearest(&point, last, within_m2)?;
    let row = i32::from(last[first].row);
    let (mut second, mut third) = (Nearest::within(within_m2), Nearest::within(within_m2));
    for (index, other) in last.iter().enumerate().filter(|(index, _)| *index != first) {
        let square_m2 = (other.point - point).norm_squared();
        match (i32::from(other.row) - row).abs() {
            0 => second.offer(index, square_m2),
            1..=ROWS => third.offer(index, square_m2),
            _ => {}
        }
    }
    Some([first, second.index?, third.index?])
}

/// Distances below this have no direction, metres.
const TOUCHING_M: f64 = 1.0e-6;
/// Weights at or below this do not count.
const WEIGHT_LEAST: f64 = 0.1;
/// How the weight falls with the distance, 1/m.
const WEIGHT_FALL: f64 = 1.8;

/// Distance of an edge from a line.
pub(super) fn from_line(
    feature: &Feature,
    step: SweepStep,
    [a, b]: [Vector3<f32>; 2],
    is_late: bool,
) -> Option<Distance> {
    let [turned, point] = step.to_start(feature);
    let (a, b) = (a.map(f64::from), b.map(f64::from));
    let along = (b - a).try_normalize(TOUCHING_M)?;
    let across = (point - a) - along * along.dot(&(point - a));
    let distance_m = libm::sqrt(across.norm_squared());
    if distance_m < TOUCHING_M {
        return None;
    }
    let direction = across / distance_m;
    let weight = if is_late { 1.0 - WEIGHT_FALL * distance_m } else { 1.0 };
    let turn = turned.cross(&direction);
    (weight > WEIGHT_LEAST).then_some(Distance { turn, step: direction, distance_m, weight })
}

/// Distance of a flat from a plane.
pub(super) fn from_plane(
    feature: &Feature,
    step: SweepStep,
    [a, b, c]: [Vector3<f32>; 3],
    is_late: bool,
) -> Option<Distance> {
    let [turned, point] = step.to_start(feature);
    let (a, b, c) = (a.map(f64::from), b.map(f64::from), c.map(f64::from));
    let normal = (b - a).cross(&(c - a)).try_normalize(TOUCHING_M)?;
    let distance_m = normal.dot(&(point - a));
    let view_m = libm::sqrt(libm::sqrt(point.norm_squared()).max(TOUCHING_M));
    let weight = if is_late { 1.0 - WEIGHT_FALL * distance_m.abs() / view_m } else { 1.0 };
    let is_used = weight > WEIGHT_LEAST && distance_m.abs() > 0.0;
    is_used.then_some(Distance { turn: turned.cross(&normal), step: normal, distance_m, weight })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(x: f32, y: f32, z: f32, row: u8) -> Feature {
        Feature { point: Vector3::new(x, y, z), row, time_share: 1.0 }
    }

    #[test]
    fn partners_are_on_the_published_rows() {
        let last = [
            feature(5.0, 0.0, 0.0, 4),
            feature(5.0, 0.3, 0.0, 4),
            feature(5.0, 0.1, 0.2, 5),
            feature(5.0, 0.0, 0.1, 8),
            feature(5.0, 0.6, 0.2, 6),
        ];
        let here = feature(5.0, 0.0, 0.01, 4);
        let step = SweepStep::default();
        assert_eq!(line(&here, step, &last, 25.0), Some([0, 2]), "row 8 is too far");
        assert_eq!(triangle(&here, step, &last, 25.0), Some([0, 1, 2]));
        assert_eq!(triangle(&here, step, &last[..2], 25.0), None);
        assert_eq!(line(&feature(15.0, 0.0, 0.0, 4), step, &last, 25.0), None);
    }

    #[test]
    fn derivatives_agree_with_small_motions() {
        let line = [Vector3::new(4.0, 1.0, -1.0), Vector3::new(4.1, 1.2, 1.0)];
        let plane = [Vector3::new(4.0, 1.0, -1.0), Vector3::new(4.1, 1.9, 1.0), Vector3::new(5.0, 0.0, 0.2)];
        let here = feature(4.4, 0.8, 0.3, 3);
        let at = |turn: Vector3<f64>, step_m: Vector3<f64>| SweepStep { angles_rad: turn, step_m };
        let measures: [&dyn Fn(SweepStep) -> Distance; 2] =
            [&|step| from_line(&here, step, line, false).unwrap(), &|step| {
                from_plane(&here, step, plane, false).unwrap()
            }];
        for measure in measures {
            let exact = measure(SweepStep::default());
            for axis in 0..3 {
                let mut by = Vector3::zeros();
                by[axis] = 1.0e-6;
                let none = Vector3::zeros();
                let turn = (measure(at(by, none)).distance_m - measure(at(-by, none)).distance_m) / 2.0e-6;
                let step = (measure(at(none, by)).distance_m - measure(at(none, -by)).distance_m) / 2.0e-6;
                assert!((turn - exact.turn[axis]).abs() < 1.0e-5, "{axis}: {turn} {exact:?}");
                assert!((step - exact.step[axis]).abs() < 1.0e-5, "{axis}: {step} {exact:?}");
            }
        }
    }
}
