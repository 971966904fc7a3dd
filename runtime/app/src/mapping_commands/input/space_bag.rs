//! Revolutions of a lidar in recordings and bags: our raw datagrams, or point clouds of ROS 2; with wheels and gyroscope.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, Packet};
use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_mapping_host::Se2;
use floorguard_recording::{RawStream, ReadError, Recorded, Recording, decode, octets_of};
use nalgebra::Vector3;

use super::aids::{AidsFound, GyroscopeSample};
use super::cloud_sweep::sweep_of_cloud;
use super::odometry_topic::chosen_odometry;
use super::sweeps::{Cutter, HOUR_US, SweepSink, SweepsRead, begins};
use crate::recordings::{FrameTree, flat, is_base};
use floorguard_mapping_host::input::OdometryTrack;

/// Where the revolutions are.
#[derive(Clone, Debug)]
pub enum SweepSource {
    /// Datagrams of this lidar; its clock is so many microseconds behind that of the recording.
    Datagrams { model: Model, offset_us: i64 },
    /// Clouds under this topic.
    Clouds { topic: String },
}

/// What the first reading of the files finds.
#[derive(Debug, Default)]
pub struct SpaceSurvey {
    decoder: Option<Decoder>,
    offset_us: Option<i64>,
    last_azimuth: Option<u16>,
    last_stamp_us: Option<u32>,
    hours_us: i64,
    revolutions: u64,
    /// Clouds of each topic, with the frame of the first.
    clouds: BTreeMap<String, (u64, String)>,
    odometry: BTreeMap<String, OdometryTrack>,
    by_frames: OdometryTrack,
    gyroscope: BTreeMap<String, (String, Vec<GyroscopeSample>)>,
    frames: FrameTree,
    others: BTreeMap<String, String>,
}

/// What was found.
pub struct Surveyed {
    /// Where the revolutions are.
    pub source: SweepSource,
    /// How many, about.
    pub sweeps: u64,
    /// Frame of the returns.
    pub frame: String,
    /// Wheels and gyroscope.
    pub aids: AidsFound,
}

type Messages = Recording<BufReader<Box<dyn Read + Send>>>;

fn open(path: &Path) -> Result<Messages, BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", path.display()));
    Ok(Recording::new(BufReader::new(File::open(path).and_then(unpacked).map_err(bad)?)))
}

fn kind(schema: &str) -> &str {
    schema.rsplit('/').next().unwrap_or(schema)
}

fn seconds(stamp: floorguard_types::time::Stamp) -> f64 {
    stamp.as_micros() as f64 * 1.0e-6
}

fn is_raw(message: &Recorded) -> bool {
    &*message.topic == RawStream::Lidar.topic()
}

impl SpaceSurvey {
    /// For a lidar of this model.
    pub fn new(choice: ModelChoice) -> Self {
        Self { decoder: Some(Decoder::new(choice)), ..Self::default() }
    }

    /// Reads a file up to its end or its cut.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn read(&mut self, path: &Path) -> Result<(), BadInput> {
        for message in open(path)?.map_while(Result::ok) {
            // A damaged message says nothing; the others do.
            let _ = if is_raw(&message) { self.datagram(&message) } else { self.message(&message) };
        }
        Ok(())
    }

    /// The delay of the network is least for the datagram that hurried most.
    fn datagram(&mut self, message: &Recorded) -> Option<()> {
        let datagram = octets_of(&message.data)?;
        self.decoder.as_mut()?.decode(datagram, message.published).ok()?;
        let packet = Packet::new_checked(datagram).ok()?;
        let stamp_us = packet.stamp_us();
        if self.last_stamp_us.replace(stamp_us).is_some_and(|last| last > stamp_us) {
            self.hours_us += HOUR_US;
        }
        let arrived_us = i64::try_from(message.published.as_micros()).ok()?;
        let offset_us = arrived_us - self.hours_us - i64::from(stamp_us);
        self.offset_us = Some(self.offset_us.map_or(offset_us, |least| least.min(offset_us)));
        for azimuth in packet.azimuths() {
            self.revolutions += u64::from(begins(&mut self.last_azimuth, azimuth));
        }
        Some(())
    }

    fn message(&mut self, message: &Recorded) -> Option<()> {
        let topic = message.topic.to_string();
        if &*message.encoding != "cdr" {
            self.others
                .insert(topic, format!("{}, serialised as {:?}", kind(&message.schema), &*message.encoding));
            return None;
        }
        match kind(&message.schema) {
            "PointCloud2" => {
                let frame = decode::cloud(&message.data)?.header.frame;
                self.clouds.entry(topic).or_insert((0, frame)).0 += 1;
            }
            "Odometry" => {
                let odometry = decode::odometry(&message.data)?;
                let time_s = seconds(odometry.header.stamp);
                self.odometry.entry(topic).or_default().push(time_s, Se2::from(odometry.pose));
            }
            "Imu" => {
                let imu = decode::imu(&message.data)?;
                let rate_radps = Vector3::from(imu.angular_radps.map(f64::from));
                let sample = GyroscopeSample { time_s: seconds(imu.header.stamp), rate_radps };
                let (_, samples) = self.gyroscope.entry(topic).or_insert((imu.header.frame, Vec::new()));
                let is_later = samples.last().is_none_or(|last| sample.time_s > last.time_s);
                if is_later && rate_radps.iter().all(|rate| rate.is_finite()) {
                    samples.push(sample);
                }
            }
            "TFMessage" => {
                for frame in decode::frames(&message.data)? {
                    if is_base(&frame.child) && frame.header.frame.trim_start_matches('/') == "odom" {
                        self.by_frames.push(seconds(frame.header.stamp), Se2::from(flat(&frame.transform)));
                    }
                    self.frames.enter(&frame);
                }
            }
            kind => {
                self.others.entry(topic).or_insert_with(|| kind.to_owned());
            }
        }
        Some(())
    }

    /// The datagrams if there are any, otherwise the topic with most clouds.
    ///
    /// # Errors
    /// There is neither; the message says what is.
    pub fn choose(mut self) -> Result<Surveyed, String> {
        let model = self.decoder.as_ref().and_then(Decoder::model);
        let clouds = self.clouds.iter().max_by_key(|(_, (count, _))| *count);
        let (source, sweeps, frame) = match (model.zip(self.offset_us), clouds) {
            (Some((model, offset_us)), _) => {
                (SweepSource::Datagrams { model, offset_us }, self.revolutions, "lidar".to_owned())
            }
            (None, Some((topic, (count, frame)))) => {
                (SweepSource::Clouds { topic: topic.clone() }, *count, frame.clone())
            }
            (None, None) => {
                let others: Vec<String> =
                    self.others.iter().map(|(topic, kind)| format!("{topic} ({kind})")).collect();
                return Err(format!(
                    "no lidar in space in it (PointCloud2, {}); it holds {}",
                    RawStream::Lidar.topic(),
                    others.join(", ")
                ));
            }
        };
        let (gyroscope_frame, gyroscope) =
            self.gyroscope.pop_first().map(|(_, found)| found).unwrap_or_default();
        let odometry = chosen_odometry(self.odometry).unwrap_or(self.by_frames);
        let aids = AidsFound { odometry, gyroscope, frames: self.frames, gyroscope_frame };
        Ok(Surveyed { source, sweeps, frame, aids })
    }
}

/// Hands over the revolutions of a file; answers why it ended early, if it did.
///
/// # Errors
/// It cannot be opened, or what `take` says.
pub fn read_space_bag(
    path: &Path,
    source: &SweepSource,
    (cutter, read): (&mut Option<Cutter>, &mut SweepsRead),
    take: &mut SweepSink<'_>,
) -> anyhow::Result<Option<String>> {
    let why = |error: ReadError| format!("{}: {error}", path.display());
    for message in open(path)? {
        let message = match message {
            Ok(message) => message,
            Err(error) => return Ok(Some(why(error))),
        };
        match source {
            SweepSource::Datagrams { model, offset_us } if is_raw(&message) => {
                let cutter = cutter.get_or_insert_with(|| Cutter::new(*model, *offset_us));
                // What is damaged is refused there.
                let datagram = octets_of(&message.data).unwrap_or_default();
                cutter.datagram((datagram, message.published), read, take)?;
            }
            SweepSource::Clouds { topic } if **topic == *message.topic => {
                read.packets += 1;
                match decode::cloud(&message.data).and_then(|cloud| sweep_of_cloud(&cloud)) {
                    Some(sweep) => take(sweep)?,
                    None => read.refused += 1,
                }
            }
            _ => {}
        }
    }
    Ok(None)
}
