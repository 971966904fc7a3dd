//! Where a sensor could have seen a person: a track behind something, or in a sector without data, is not missed.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{nearest_f32, saturating_u32, truncating_u16};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::{BeamReturn, ScanOf};

/// Sectors of 2°.
const SECTORS: usize = 180;
/// An obstacle this much nearer than a person hides the person, metres.
const MARGIN_M: f32 = 0.6;
/// Columns or beams that make a sector known; of nine columns of the lidar, or of four beams at 0.5°.
const MEASURED_MIN: u16 = 3;
/// Half the breadth of a pair of legs, metres.
const LEGS_HALF_M: f32 = 0.15;

/// Horizontal distance up to which each sector is open.
#[derive(Clone, Debug)]
pub(crate) struct Visibility {
    nearest: [Nearest; SECTORS],
    measured: [u16; SECTORS],
}

/// Nearest and second nearest obstacle of a sector, counts of 2 mm: one stray return hides nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    first: u16,
    second: u16,
}

impl Nearest {
    const NOTHING: Self = Self { first: u16::MAX, second: u16::MAX };

    /// An obstacle of the sector.
    #[inline]
    pub(crate) fn include(&mut self, distance: u16) {
        // Most stand behind both.
        if distance < self.second {
            self.second = self.first.max(distance);
            self.first = self.first.min(distance);
        }
    }
}

impl Visibility {
    pub(crate) const fn new() -> Self {
        Self { nearest: [Nearest::NOTHING; SECTORS], measured: [0; SECTORS] }
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::new();
    }

    /// The state of the sector of a column of the lidar, to be updated with its obstacles and stored again.
    pub(crate) fn sector(&self, azimuth_cdeg: u16) -> Nearest {
        self.nearest.get(sector_of_cdeg(azimuth_cdeg)).copied().unwrap_or(Nearest::NOTHING)
    }

    /// A column of the lidar was measured, which leaves its sector so.
    pub(crate) fn measured(&mut self, azimuth_cdeg: u16, nearest: Nearest) {
        let sector = sector_of_cdeg(azimuth_cdeg);
        if let (Some(count), Some(slot)) = (self.measured.get_mut(sector), self.nearest.get_mut(sector)) {
            *count = count.saturating_add(1);
            *slot = nearest;
        }
    }

    /// A person at `point_in_sensor` (x forward, y left) could have been seen.
    pub(crate) fn is_visible(&self, point_in_sensor: Point2) -> bool {
        let sector = sector_of(point_in_sensor);
        let measured = self.measured.get(sector).copied().unwrap_or(0);
        let nearest = self.nearest.get(sector).map_or(0, |nearest| nearest.second);
        measured >= MEASURED_MIN && reaches(nearest, point_in_sensor)
    }
}

/// How far each sector of a moment was open, from where the sensor was then. Small enough to wait in a queue.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenSpace {
    /// From the fixed frame into that of the sensor.
    into_sensor: Pose2,
    /// People farther away are not recognised, metres.
    range_max_m: f32,
    /// Nearest obstacle, counts of 2 mm; 0 where nothing is known.
    open: [u16; SECTORS],
}

impl OpenSpace {
    /// Nothing is known of anywhere.
    pub const BLIND: Self = Self {
        into_sensor: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
        range_max_m: 0.0,
        open: [0; SECTORS],
    };

    /// What a scanner at `sensor_in_odom` could see, which recognises legs up to `range_max_m`.
    pub fn measure<P: Profile>(&mut self, scan: &ScanOf<P>, sensor_in_odom: Pose2, range_max_m: f32) {
        let mut sectors = Visibility::new();
        for (index, beam) in scan.beams.iter().enumerate() {
            let bearing_rad = scan.first_angle_rad + scan.step_rad * nearest_f32(index);
            let distance = match beam {
                BeamReturn::Hit(range_mm) => Some(range_mm / 2),
                BeamReturn::Free(_) => None,
                BeamReturn::Unknown => continue,
            };
            let azimuth_cdeg = azimuth_of(bearing_rad);
            let mut nearest = sectors.sector(azimuth_cdeg);
            distance.into_iter().for_each(|distance| nearest.include(distance));
            sectors.measured(azimuth_cdeg, nearest);
        }
        (self.into_sensor, self.range_max_m) = (sensor_in_odom.inverse(), range_max_m);
        for (open, (nearest, measured)) in
            self.open.iter_mut().zip(sectors.nearest.iter().zip(sectors.measured))
        {
            // One stray return hides nothing here, too.
            *open = if measured >= MEASURED_MIN { nearest.second.max(1) } else { 0 };
        }
    }

    /// Both legs of a person at `point` of the fixed frame could have been seen.
    #[must_use]
    pub fn is_visible(&self, point: Point2) -> bool {
        let place = self.into_sensor.transform(point);
        let distance_m = place.norm();
        let aside = LEGS_HALF_M / distance_m.max(LEGS_HALF_M);
        // Left leg, middle, right leg.
        let places = [-aside, 0.0, aside]
            .map(|turn| Point2::new(place.x_m - turn * place.y_m, place.y_m + turn * place.x_m));
        let is_open = |place: &Point2| {
            let open = self.open.get(sector_of(*place)).copied().unwrap_or(0);
            open != 0 && reaches(open, *place)
        };
        distance_m <= self.range_max_m && places.iter().all(is_open)
    }
}

/// A sector that is open up to so many counts shows who stands at a place. Farther than anything is looked for is open.
fn reaches(open: u16, place: Point2) -> bool {
    open == u16::MAX || f32::from(open) * 0.002 > place.norm() - MARGIN_M
}

fn sector_of(point_in_sensor: Point2) -> usize {
    sector_of_bearing(libm::atan2f(point_in_sensor.y_m, point_in_sensor.x_m))
}

fn sector_of_bearing(bearing_rad: f32) -> usize {
    sector_of_cdeg(azimuth_of(bearing_rad))
}

/// Counter-clockwise bearings, ±2π, to the lidar's clockwise azimuths, hundredths of a degree.
fn azimuth_of(bearing_rad: f32) -> u16 {
    truncating_u16(saturating_u32(-bearing_rad * (18_000.0 / core::f32::consts::PI) + 36_000.0) % 36_000)
}

fn sector_of_cdeg(azimuth_cdeg: u16) -> usize {
    usize::from(azimuth_cdeg) / 200 % SECTORS
}

const _: () = assert!(SECTORS * 200 == 36_000);

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::sensing::Scan;

    /// 270° at 0.5°, everything free up to 30 m, but for what `of` says of a bearing in degrees.
    fn scan(of: impl Fn(f32) -> Option<BeamReturn>) -> Scan {
        let first_angle_rad = (-135.0_f32).to_radians();
        let mut scan = Scan { first_angle_rad, step_rad: 0.5_f32.to_radians(), ..Scan::default() };
        for beam in 0..541_u16 {
            let beam = of(0.5 * f32::from(beam) - 135.0).unwrap_or(BeamReturn::Free(30_000));
            scan.beams.push(beam).expect("room");
        }
        scan
    }

    fn open(of: impl Fn(f32) -> Option<BeamReturn>) -> OpenSpace {
        let mut open = OpenSpace::BLIND;
        open.measure(&scan(of), Pose2::new(1.0, 0.0, 0.0), 5.0);
        open
    }

    #[test]
    fn no_miss_behind_scanner_or_too_far() {
        let free = open(|_| None);
        assert!(free.is_visible(Point2::new(4.0, 1.0)));
        assert!(!free.is_visible(Point2::new(-2.0, 0.0)), "the scanner sees 270°");
        assert!(!free.is_visible(Point2::new(7.0, 0.0)), "legs have too few returns there");
        assert!(!OpenSpace::BLIND.is_visible(Point2::new(2.0, 0.0)));
    }

    #[test]
    fn no_miss_when_hidden_or_dazzled() {
        let column = |bearing: f32| (bearing.abs() < 6.0).then_some(BeamReturn::Hit(1_500));
        assert!(!open(column).is_visible(Point2::new(4.0, 0.0)), "behind a column");
        assert!(open(column).is_visible(Point2::new(2.6, 0.0)), "the column itself may be the person");
        assert!(open(column).is_visible(Point2::new(4.0, 1.0)));
        let half = |bearing: f32| (bearing > 1.5 && bearing < 9.0).then_some(BeamReturn::Hit(1_500));
        assert!(!open(half).is_visible(Point2::new(4.0, 0.0)), "one leg is hidden");
        let dazzled = |bearing: f32| (bearing.abs() < 6.0).then_some(BeamReturn::Unknown);
        assert!(!open(dazzled).is_visible(Point2::new(4.0, 0.0)));
        assert!(open(dazzled).is_visible(Point2::new(4.0, 1.0)));
    }
}
