//! `replay --record`: what a capture, a bag or a log holds and what was found in it, as a recording for other tools.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use floorguard_perception::people::RingAngles;
use floorguard_types::geometry::{Pose2, Transform3, Twist2};
use floorguard_types::sensing::{Scan, Sweep};
use floorguard_types::time::Stamp;

use super::rows::PersonRow;
use floorguard_host::outcome::BadInput;
use floorguard_recording::{
    Marker, MotionRow, RUN_METADATA, RawStream, RecordError, Recorder, Times, describe, sweep_points, topics,
};

/// A recording in the making, or none.
pub struct Recorded {
    recorder: Option<Recorder<BufWriter<File>>>,
    /// Where the lidar is mounted, once it is written.
    lidar_in_base: Option<Transform3>,
    failed: Result<(), RecordError>,
}

impl Recorded {
    /// Starts the recording of a file by its name.
    ///
    /// # Errors
    /// The recording would overwrite its source, or cannot be made.
    pub fn open(source: &Path, wanted: Option<&Path>) -> anyhow::Result<Self> {
        let none = Self { recorder: None, lidar_in_base: None, failed: Ok(()) };
        let Some(path) = wanted else { return Ok(none) };
        let bad = |why: &dyn std::fmt::Display| BadInput(format!("--record {}: {why}", path.display()));
        if path.exists() && path.canonicalize().ok() == source.canonicalize().ok() {
            return Err(bad(&"this is the file that is read").into());
        }
        let file = File::create(path).map_err(|error| bad(&error))?;
        let mut recorder = Recorder::new(BufWriter::new(file)).map_err(|error| bad(&error))?;
        let name = source.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let texts = [("title", name), ("version", env!("CARGO_PKG_VERSION").to_owned())];
        let texts: BTreeMap<_, _> = texts.into_iter().map(|(key, text)| (key.to_owned(), text)).collect();
        recorder.metadata(RUN_METADATA, texts).map_err(|error| bad(&error))?;
        Ok(Self { recorder: Some(recorder), ..none })
    }

    fn write(&mut self, write: impl FnOnce(&mut Recorder<BufWriter<File>>) -> Result<(), RecordError>) {
        if let (Some(recorder), Ok(())) = (&mut self.recorder, &self.failed) {
            self.failed = write(recorder);
        }
    }

    /// A datagram of the lidar.
    pub fn datagram(&mut self, at: Stamp, bytes: &[u8]) {
        self.write(|out| out.raw(RawStream::Lidar, at, bytes));
    }

    /// A sweep and the people that were found in it; `lidar` and the robot's place are those that were used.
    pub fn sweep(
        &mut self,
        (sweep, angles): (&Sweep, &RingAngles),
        (lidar, motion): (&Transform3, (Pose2, Twist2)),
        people: &[PersonRow],
    ) {
        if self.recorder.is_none() {
            return;
        }
        let logged = sweep.end_stamp;
        if self.lidar_in_base != Some(*lidar) {
            self.lidar_in_base = Some(*lidar);
            self.write(|out| out.mounting(logged, "lidar", lidar));
        }
        self.motion(logged, motion);
        let points = sweep_points(sweep, angles);
        self.write(|out| {
            out.points(Times { logged, published: sweep.stamp }, (sweep.stamp, "lidar"), &points)
        });
        self.people(logged, people);
    }

    /// A scan, where its scanner was, and the people that were found in it.
    pub fn scan(&mut self, scan: &Scan, scanner: Pose2, people: &[PersonRow]) {
        if self.recorder.is_none() {
            return;
        }
        // The scanner stands for the robot: nothing else is known to be anywhere.
        self.write(|out| out.mounting(scan.stamp, "scanner", &Transform3::IDENTITY));
        self.motion(scan.stamp, (scanner, Twist2::ZERO));
        self.write(|out| out.scan(scan.stamp, scan));
        self.people(scan.stamp, people);
    }

    fn motion(&mut self, stamp: Stamp, (pose_in_odom, twist): (Pose2, Twist2)) {
        let row = MotionRow { stamp, pose_in_odom, twist, covariance: [[0.0; 3]; 3] };
        self.write(|out| out.motion(stamp, &row));
    }

    fn people(&mut self, at: Stamp, people: &[PersonRow]) {
        let drawn: Vec<Marker> = people.iter().flat_map(|row| describe::person(&row.report())).collect();
        self.write(|out| out.markers(topics::PEOPLE, (at, "odom"), &drawn));
    }

    /// Closes the recording.
    ///
    /// # Errors
    /// It could not be written.
    pub fn finish(self) -> anyhow::Result<()> {
        self.failed?;
        if let Some(recorder) = self.recorder {
            recorder.finish()?;
        }
        Ok(())
    }
}
