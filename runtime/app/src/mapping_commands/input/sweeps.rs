//! Revolutions out of the datagrams of a lidar: every return with its own time, cut where the azimuth begins anew.

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, Packet, Return, Returns, ReturnsOf};
use floorguard_mapping::lidar_odometry::SweepReturn;
use floorguard_mapping_host::lidar3d::SweepRecord;
use floorguard_types::time::Stamp;

/// Sensor times begin anew every hour, microseconds.
pub(super) const HOUR_US: i64 = 3_600_000_000;
/// A revolution begins where the azimuth falls by more than this, hundredths of a degree: a lidar that is set to a field of
/// view falls by little.
const FALL_CDEG: u16 = 1_000;
/// The last revolution is a part if it has fewer returns than this share of the largest.
const PART: f64 = 0.9;

/// What was read.
#[derive(Clone, Debug, Default)]
pub struct SweepsRead {
    /// Datagrams of the lidar.
    pub packets: u64,
    /// Those that were no packet of this lidar, or came twice.
    pub refused: u64,
    /// Revolutions at the ends that are parts.
    pub parts: u64,
    /// Why a file could not be read to its end.
    pub ended: Option<String>,
}

/// Whether a revolution begins with this azimuth.
pub fn begins(last: &mut Option<u16>, azimuth_cdeg: u16) -> bool {
    azimuth_cdeg < 36_000
        && last
            .replace(azimuth_cdeg)
            .is_some_and(|last| last > azimuth_cdeg && last - azimuth_cdeg > FALL_CDEG)
}

/// Takes revolutions one by one.
pub type SweepSink<'a> = dyn FnMut(SweepRecord) -> anyhow::Result<()> + 'a;

/// Cuts the stream of one lidar.
pub struct Cutter {
    returns: Returns,
    /// Refuses what came twice or is no packet.
    decoder: Decoder,
    ring: Vec<u8>,
    building: Vec<(i64, Return)>,
    last_azimuth: Option<u16>,
    last_stamp_us: Option<u32>,
    hours_us: i64,
    largest: usize,
    has_begun: bool,
    /// From the clock of the lidar to that of the log, microseconds.
    offset_us: i64,
}

impl Cutter {
    /// For one model; `offset_us` leads from its clock to that of the log.
    pub fn new(model: Model, offset_us: i64) -> Self {
        Self {
            returns: Returns::new(model),
            decoder: Decoder::new(ModelChoice::Fixed(model)),
            ring: model.angles().iter().map(|angles| angles.ring).collect(),
            building: Vec::new(),
            last_azimuth: None,
            last_stamp_us: None,
            hours_us: 0,
            largest: 0,
            has_begun: false,
            offset_us,
        }
    }

    /// The lidar that it cuts the stream of.
    pub const fn model(&self) -> Model {
        self.returns.model()
    }

    /// A datagram of the lidar.
    ///
    /// # Errors
    /// What `take` says.
    pub fn datagram(
        &mut self,
        (payload, arrival): (&[u8], Stamp),
        read: &mut SweepsRead,
        take: &mut SweepSink<'_>,
    ) -> anyhow::Result<()> {
        read.packets += 1;
        let accepted = self.decoder.decode(payload, arrival).is_ok();
        let Some(packet) = Packet::new_checked(payload).ok().filter(|_| accepted) else {
            read.refused += 1;
            return Ok(());
        };
        let stamp_us = packet.stamp_us();
        if self.last_stamp_us.replace(stamp_us).is_some_and(|last| last > stamp_us) {
            self.hours_us += HOUR_US;
        }
        self.packet(&packet, self.hours_us + i64::from(stamp_us) + self.offset_us, read, take)
    }

    fn packet(
        &mut self,
        packet: &Packet<'_>,
        stamp_us: i64,
        read: &mut SweepsRead,
        take: &mut SweepSink<'_>,
    ) -> anyhow::Result<()> {
        let mut found = Vec::new();
        self.returns.for_each(packet, ReturnsOf::DistinctEchoes, |each| found.push(each));
        let mut found = found.into_iter().peekable();
        for (block, azimuth) in packet.azimuths().into_iter().enumerate() {
            if begins(&mut self.last_azimuth, azimuth) {
                self.complete(read, take)?;
            }
            while let Some(each) = found.next_if(|each| usize::from(each.block) == block) {
                self.building.push((stamp_us * 1_000 + i64::from(each.offset_ns), each));
            }
        }
        Ok(())
    }

    /// The first revolution of a capture and the last one are parts.
    fn complete(&mut self, read: &mut SweepsRead, take: &mut SweepSink<'_>) -> anyhow::Result<()> {
        let building = std::mem::take(&mut self.building);
        self.largest = self.largest.max(building.len());
        if !std::mem::replace(&mut self.has_begun, true) {
            read.parts += 1;
            return Ok(());
        }
        self.record(&building).map_or(Ok(()), take)
    }

    /// What is left belongs to a revolution without an end: used if it is most of one.
    ///
    /// # Errors
    /// What `take` says.
    pub fn finish(mut self, read: &mut SweepsRead, take: &mut SweepSink<'_>) -> anyhow::Result<()> {
        let building = std::mem::take(&mut self.building);
        if self.has_begun && (building.len() as f64) < PART * self.largest as f64 {
            read.parts += 1;
            return Ok(());
        }
        self.record(&building).map_or(Ok(()), take)
    }

    /// `None` without two times.
    fn record(&self, building: &[(i64, Return)]) -> Option<SweepRecord> {
        let ((first_ns, _), (last_ns, _)) = (building.first()?, building.last()?);
        let duration_ns = last_ns - first_ns;
        if duration_ns <= 0 {
            return None;
        }
        let share = |time_ns: i64| (time_ns - first_ns) as f32 / duration_ns as f32;
        let returns = building.iter().map(|(time_ns, each)| {
            let ring = self.ring.get(usize::from(each.laser)).copied().unwrap_or(u8::MAX);
            SweepReturn::new(each.point_in_sensor, share(*time_ns), ring)
        });
        Some(SweepRecord {
            end_s: *last_ns as f64 * 1.0e-9,
            duration_s: duration_ns as f64 * 1.0e-9,
            returns: returns.collect(),
            reflectivity: building.iter().map(|(_, each)| each.reflectivity).collect(),
        })
    }
}
