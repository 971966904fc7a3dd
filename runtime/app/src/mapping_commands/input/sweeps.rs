//! Revolutions out of lidar captures: every return with its own time, cut where the azimuth begins anew.

use std::path::{Path, PathBuf};

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, Packet, Return, Returns, ReturnsOf};
use floorguard_mapping::lidar_odometry::SweepReturn;
use floorguard_mapping_host::lidar3d::SweepRecord;
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT, settle_model};
use floorguard_types::time::Stamp;

/// Sensor times begin anew every hour, microseconds.
const HOUR_US: i64 = 3_600_000_000;
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

/// Reads the revolutions of captures, one after the other, and gives each to `take`.
///
/// # Errors
/// A file that is no capture of a lidar, or what `take` says.
pub fn read_sweeps(
    files: &[PathBuf],
    choice: ModelChoice,
    take: &mut dyn FnMut(SweepRecord) -> anyhow::Result<()>,
) -> anyhow::Result<SweepsRead> {
    let mut read = SweepsRead::default();
    let mut cutter: Option<Cutter> = None;
    for file in files {
        let model = settle_model(file, choice)?;
        let cutter = match &mut cutter {
            Some(cutter) if cutter.returns.model() == model => cutter,
            other => other.insert(Cutter::new(model)),
        };
        if !cutter.read(file, &mut read, take)? {
            break;
        }
    }
    if let Some(cutter) = cutter {
        cutter.finish(&mut read, take)?;
    }
    Ok(read)
}

/// Number of revolutions in captures, for the display of progress; 0 of what cannot be read.
pub fn count_sweeps(files: &[PathBuf]) -> u64 {
    let mut count = 0;
    let mut last = None;
    for file in files {
        let Ok(capture) = Capture::open(file) else { continue };
        for datagram in capture.flatten().filter(|datagram| datagram.destination_port == LIDAR_DATA_PORT) {
            let Ok(packet) = Packet::new_checked(&datagram.payload) else { continue };
            for azimuth in packet.azimuths() {
                count += u64::from(begins(&mut last, azimuth));
            }
        }
    }
    count
}

fn begins(last: &mut Option<u16>, azimuth_cdeg: u16) -> bool {
    azimuth_cdeg < 36_000
        && last
            .replace(azimuth_cdeg)
            .is_some_and(|last| last > azimuth_cdeg && last - azimuth_cdeg > FALL_CDEG)
}

/// Cuts the stream of one lidar.
struct Cutter {
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
}

impl Cutter {
    fn new(model: Model) -> Self {
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
        }
    }

    /// True if the file could be read to its end.
    fn read(
        &mut self,
        file: &Path,
        read: &mut SweepsRead,
        take: &mut dyn FnMut(SweepRecord) -> anyhow::Result<()>,
    ) -> anyhow::Result<bool> {
        for datagram in Capture::open(file)? {
            let datagram = match datagram {
                Ok(datagram) => datagram,
                Err(error) => {
                    read.ended = Some(error.to_string());
                    return Ok(false);
                }
            };
            if datagram.destination_port != LIDAR_DATA_PORT {
                continue;
            }
            read.packets += 1;
            let arrival = Stamp::from_micros(datagram.captured_us);
            let accepted = self.decoder.decode(&datagram.payload, arrival).is_ok();
            let Some(packet) = Packet::new_checked(&datagram.payload).ok().filter(|_| accepted) else {
                read.refused += 1;
                continue;
            };
            let stamp_us = packet.stamp_us();
            if self.last_stamp_us.replace(stamp_us).is_some_and(|last| last > stamp_us) {
                self.hours_us += HOUR_US;
            }
            self.packet(&packet, self.hours_us + i64::from(stamp_us), read, take)?;
        }
        Ok(true)
    }

    fn packet(
        &mut self,
        packet: &Packet<'_>,
        stamp_us: i64,
        read: &mut SweepsRead,
        take: &mut dyn FnMut(SweepRecord) -> anyhow::Result<()>,
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
    fn complete(
        &mut self,
        read: &mut SweepsRead,
        take: &mut dyn FnMut(SweepRecord) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let building = std::mem::take(&mut self.building);
        self.largest = self.largest.max(building.len());
        if !std::mem::replace(&mut self.has_begun, true) {
            read.parts += 1;
            return Ok(());
        }
        self.record(&building).map_or(Ok(()), take)
    }

    /// What is left belongs to a revolution without an end: used if it is most of one.
    fn finish(
        mut self,
        read: &mut SweepsRead,
        take: &mut dyn FnMut(SweepRecord) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
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
