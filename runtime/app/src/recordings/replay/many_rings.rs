//! Revolutions of a lidar with more rings than the stages have: sixteen of them, spread over its field of view.

use floorguard_drivers::velodyne::{Model, Packet, Return, Returns, ReturnsOf};
use floorguard_perception::people::RingAngles;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::cloud::{CloudSorter, Point};

/// Behind the sensor, where revolutions are cut; hundredths of a degree.
const CUT_CDEG: u32 = 18_000;
/// Half a turn: an angle from the cut that falls by more has come round.
const HALF_CDEG: u32 = 18_000;

/// Collects the returns of a revolution.
pub struct ManyRings {
    returns: Returns,
    sorter: CloudSorter,
    points: Vec<Point>,
    /// Angle of the newest block from the cut, hundredths of a degree.
    last_cdeg: Option<u32>,
    began: Option<Stamp>,
    /// Time of the newest packet.
    newest: Stamp,
    sweep: Box<Sweep>,
}

impl ManyRings {
    /// Of a lidar of that model.
    pub fn new(model: Model) -> Self {
        Self {
            returns: Returns::new(model),
            sorter: CloudSorter::default(),
            points: Vec::new(),
            last_cdeg: None,
            began: None,
            newest: Stamp::ZERO,
            sweep: Box::new(Sweep::EMPTY),
        }
    }

    /// Takes in a packet of that time; hands out the revolution that ends in it, with the elevations of its rings.
    pub fn add(&mut self, payload: &[u8], stamp: Stamp, mut complete: impl FnMut(&Sweep, RingAngles)) {
        let Ok(packet) = Packet::new_checked(payload) else { return };
        let mut found: Vec<Return> = Vec::new();
        self.returns.for_each(&packet, ReturnsOf::DistinctEchoes, |each| found.push(each));
        let mut found = found.into_iter().peekable();
        for (block, azimuth_cdeg) in packet.azimuths().into_iter().enumerate() {
            let from_cut = (u32::from(azimuth_cdeg) + 36_000 - CUT_CDEG) % 36_000;
            if self.last_cdeg.replace(from_cut).is_some_and(|last| last > from_cut + HALF_CDEG) {
                self.finish(&mut complete);
            }
            self.began.get_or_insert(stamp);
            self.newest = stamp;
            while let Some(each) = found.next_if(|each| usize::from(each.block) == block) {
                let place = each.point_in_sensor;
                self.points.push(Point {
                    position_m: [place.x_m, place.y_m, place.z_m],
                    ring: Some(u16::from(each.laser)),
                    reflectivity: each.reflectivity,
                });
            }
        }
    }

    /// Hands out the revolution so far.
    pub fn finish(&mut self, complete: &mut impl FnMut(&Sweep, RingAngles)) {
        let Some(began) = self.began.take() else { return };
        let took_us = u32::try_from(began.past_us(self.newest)).unwrap_or(u32::MAX).max(1);
        self.sorter.sweep_of(&self.points, (began, took_us), &mut self.sweep);
        self.points.clear();
        complete(&self.sweep, self.sorter.angles());
    }
}
