//! Scans of a recording or bag: `LaserScan` with `Odometry` or the moving frame `odom` → base, the turns of a gyroscope, and the
//! mounting of the scanner.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::{OdometryTrack, ScanRecord};
use floorguard_recording::decode::{self, LaserScan};
use floorguard_recording::{Recorded, Recording};

use super::drive::Sink;
use super::odometry_topic::chosen_odometry;
use super::turn_sum::TurnSum;
use crate::recordings::{FrameTree, flat, is_base};

/// What the first reading of bags finds.
#[derive(Debug, Default)]
pub struct BagSurvey {
    /// Scans of each topic.
    pub scans: BTreeMap<String, u64>,
    /// Other topics with their kind.
    pub others: BTreeMap<String, String>,
    odometry: BTreeMap<String, OdometryTrack>,
    by_frames: OdometryTrack,
    /// Frame and turns of each topic.
    gyroscope: BTreeMap<String, (String, TurnSum)>,
    frames: FrameTree,
    /// Frame of the scans of each topic.
    scan_frames: BTreeMap<String, String>,
}

/// How the scans of a topic become records.
#[derive(Debug)]
pub struct BagScans {
    /// Which topic.
    pub topic: String,
    /// The robot over time; empty without odometry.
    pub odometry: OdometryTrack,
    /// Its heading alone, by the gyroscope; empty where there is none, or where it is mounted is not known.
    pub turned: OdometryTrack,
    /// The scanner on the robot.
    pub scanner_in_robot: Se2,
    /// The mounting was found.
    pub is_mounted: bool,
    /// It hangs upside down.
    pub is_inverted: bool,
}

fn open(path: &Path) -> Result<Recording<BufReader<Box<dyn Read + Send>>>, BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", path.display()));
    Ok(Recording::new(BufReader::new(File::open(path).and_then(unpacked).map_err(bad)?)))
}

fn kind(schema: &str) -> &str {
    schema.rsplit('/').next().unwrap_or(schema)
}

fn seconds(message_us: u64) -> f64 {
    message_us as f64 * 1.0e-6
}

impl BagSurvey {
    /// Reads a bag up to its end or its cut.
    ///
    /// # Errors
    /// It cannot be opened, or is no ROS 2.
    pub fn read(&mut self, path: &Path) -> anyhow::Result<()> {
        for message in open(path)?.map_while(Result::ok) {
            let kind = kind(&message.schema);
            let is_wanted = matches!(kind, "LaserScan" | "Odometry" | "TFMessage" | "Imu");
            if is_wanted && &*message.encoding != "cdr" {
                return Err(BadInput(format!(
                    "{}: {} is serialised as {:?}; a ROS 2 bag has \"cdr\" (convert bags of ROS 1 first)",
                    path.display(),
                    message.topic,
                    &*message.encoding
                ))
                .into());
            }
            // A damaged message says nothing; the others do.
            let _ = self.enter(kind, &message);
        }
        Ok(())
    }

    fn enter(&mut self, kind: &str, message: &Recorded) -> Option<()> {
        let topic = message.topic.to_string();
        match kind {
            "LaserScan" => {
                *self.scans.entry(topic.clone()).or_default() += 1;
                if let Entry::Vacant(frame) = self.scan_frames.entry(topic) {
                    frame.insert(decode::laser_scan(&message.data)?.header.frame);
                }
            }
            "Odometry" => {
                let odometry = decode::odometry(&message.data)?;
                let time_s = seconds(odometry.header.stamp.as_micros());
                self.odometry.entry(topic).or_default().push(time_s, Se2::from(odometry.pose));
            }
            "Imu" => {
                let imu = decode::imu(&message.data)?;
                let (_, turns) =
                    self.gyroscope.entry(topic).or_insert((imu.header.frame, TurnSum::default()));
                turns.push(seconds(imu.header.stamp.as_micros()), imu.angular_radps);
            }
            "TFMessage" => {
                for frame in decode::frames(&message.data)? {
                    if is_base(&frame.child) && frame.header.frame.trim_start_matches('/') == "odom" {
                        let time_s = seconds(frame.header.stamp.as_micros());
                        self.by_frames.push(time_s, Se2::from(flat(&frame.transform)));
                    }
                    self.frames.enter(&frame);
                }
            }
            _ => {
                self.others.entry(topic).or_insert_with(|| kind.to_owned());
            }
        }
        Some(())
    }

    /// Chooses the topic of the scans: the one named, or the one with most scans.
    ///
    /// # Errors
    /// It is not there; the message says what is.
    pub fn choose(mut self, wanted: Option<&str>) -> Result<BagScans, String> {
        let by_count = || self.scans.iter().max_by_key(|(_, count)| **count).map(|(topic, _)| topic.clone());
        let topic = match wanted {
            Some(wanted) => self.scans.contains_key(wanted).then(|| wanted.to_owned()),
            None => by_count(),
        };
        let Some(topic) = topic else {
            let scans = self.scans.keys().map(|topic| format!("{topic} (LaserScan)"));
            let others = self.others.iter().map(|(topic, kind)| format!("{topic} ({kind})"));
            let listed: Vec<String> = scans.chain(others).collect();
            let what = wanted.map_or_else(String::new, |wanted| format!(" of topic {wanted}"));
            return Err(format!("no LaserScan{what}; it holds {}", listed.join(", ")));
        };
        let mounting = self.scan_frames.get(&topic).and_then(|frame| self.frames.mounting(frame));
        let turned = self.gyroscope.pop_first().and_then(|(_, (frame, turns))| {
            let [.., up_in_gyroscope] = self.frames.mounting(&frame)?.rotation;
            Some(turns.headings(up_in_gyroscope))
        });
        Ok(BagScans {
            topic,
            odometry: chosen_odometry(self.odometry).unwrap_or(self.by_frames),
            turned: turned.unwrap_or_default(),
            scanner_in_robot: mounting.map_or_else(Se2::default, |mounting| Se2::from(flat(&mounting))),
            is_mounted: mounting.is_some(),
            is_inverted: mounting.is_some_and(|mounting| mounting.rotation[2][2] < 0.0),
        })
    }
}

impl BagScans {
    /// Hands over every scan of the topic; answers why the bag ended early, if it did.
    ///
    /// # Errors
    /// It cannot be opened, or the sink's own.
    pub fn read(&self, path: &Path, sink: &mut Sink<'_>) -> anyhow::Result<Option<String>> {
        for message in open(path)? {
            let message = match message {
                Ok(message) => message,
                Err(error) => return Ok(Some(format!("{}: {error}", path.display()))),
            };
            if *message.topic != *self.topic || kind(&message.schema) != "LaserScan" {
                continue;
            }
            if let Some(record) = decode::laser_scan(&message.data).and_then(|scan| self.record(scan)) {
                sink(record)?;
            }
        }
        Ok(None)
    }

    fn record(&self, scan: LaserScan) -> Option<ScanRecord> {
        let angles = [scan.first_angle_rad, scan.step_rad];
        if !angles.iter().all(|angle| angle.is_finite()) || scan.step_rad.abs() < 1.0e-5 {
            return None;
        }
        let time_s = seconds(scan.middle().as_micros());
        let believed =
            |range: f32| range.is_finite() && range > scan.range_min_m.max(0.0) && range < scan.range_max_m;
        let mut ranges_m: Vec<f32> =
            scan.ranges_m.iter().map(|range| if believed(*range) { *range } else { f32::INFINITY }).collect();
        let (mut first_angle_rad, mut step_rad) = (scan.first_angle_rad, scan.step_rad);
        let mut between_s = scan.beam_interval_s();
        if self.is_inverted {
            (first_angle_rad, step_rad) = (-first_angle_rad, -step_rad);
        }
        // Beams run counter-clockwise from here on.
        if step_rad < 0.0 {
            first_angle_rad += step_rad * ranges_m.len().saturating_sub(1) as f32;
            step_rad = -step_rad;
            ranges_m.reverse();
            between_s = -between_s;
        }
        let odometry = self.odometry.at(time_s).map(|robot| robot.compose(self.scanner_in_robot));
        let motion = self.odometry.motion_at(time_s, self.scanner_in_robot).unwrap_or_default();
        Some(ScanRecord { time_s, odometry, first_angle_rad, step_rad, ranges_m, between_s, motion })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_recording::decode::Header;
    use floorguard_types::time::Stamp;

    fn scan(step_rad: f32, between_s: f32) -> LaserScan {
        LaserScan {
            header: Header { stamp: Stamp::from_micros(1_000_000), frame: "scanner".to_owned() },
            first_angle_rad: -step_rad,
            step_rad,
            between_s,
            range_min_m: 0.0,
            range_max_m: 30.0,
            ranges_m: vec![1.0, 2.0, 3.0],
        }
    }

    fn scans(is_inverted: bool) -> BagScans {
        let mut odometry = OdometryTrack::default();
        odometry.push(0.9, Se2::default());
        odometry.push(1.1, Se2::new(0.2, 0.0, 0.0));
        let scanner_in_robot = Se2::new(0.9, 0.0, 0.0);
        BagScans {
            topic: "/scan".to_owned(),
            odometry,
            turned: OdometryTrack::default(),
            scanner_in_robot,
            is_mounted: true,
            is_inverted,
        }
    }

    /// The stamp is that of the first beam; a scan is seen from its middle one, with the motion there.
    #[test]
    fn scans_have_the_motion_of_their_middle() {
        let record = scans(false).record(scan(0.1, 0.01)).unwrap();
        assert!((record.time_s - 1.01).abs() < 1.0e-6, "{}", record.time_s);
        assert_eq!((record.ranges_m[0], record.between_s), (1.0, 0.01));
        assert!((record.motion.x_m - 1.0).abs() < 1.0e-9, "{:?}", record.motion);
        // Beams that run clockwise, or from above seem to, are turned round, and so is their time.
        for (is_inverted, step_rad) in [(false, -0.1), (true, 0.1)] {
            let record = scans(is_inverted).record(scan(step_rad, 0.01)).unwrap();
            assert!((record.time_s - 1.01).abs() < 1.0e-6 && record.step_rad > 0.0);
            assert_eq!((record.ranges_m[0], record.between_s), (3.0, -0.01));
        }
        let record = scans(true).record(scan(-0.1, 0.01)).unwrap();
        assert_eq!((record.ranges_m[0], record.between_s), (1.0, 0.01));
    }

    /// What can be no time from beam to beam neither moves the returns nor the scan.
    #[test]
    fn impossible_times_of_beams_are_left_out() {
        for between_s in [0.0, -0.01, 0.3, f32::NAN, f32::INFINITY] {
            let record = scans(false).record(scan(0.1, between_s)).unwrap();
            assert_eq!((record.time_s, record.between_s), (1.0, 0.0), "{between_s}");
        }
    }
}
