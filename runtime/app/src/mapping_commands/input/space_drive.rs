//! A drive of a spinning lidar: captures, or recordings and bags, with what else they know of the motion.

use std::path::{Path, PathBuf};

use floorguard_drivers::velodyne::{ModelChoice, Packet};
use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{beginning, must_be_a_file};
use floorguard_mapping::lidar_odometry::MotionAid;
use floorguard_mapping_host::lidar3d::SweepRecord;
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT, settle_model};
use floorguard_types::time::Stamp;

use super::aids::Aids;
use super::space_bag::{SpaceSurvey, SweepSource, read_space_bag};
use super::sweeps::{Cutter, SweepSink, SweepsRead, begins};
use crate::recordings::MCAP_MAGIC;

/// So much of a file tells what it is.
const SNIFF_BYTES: u64 = 4_096;

/// Files that belong together.
pub struct SpaceDrive {
    files: Vec<PathBuf>,
    choice: ModelChoice,
    /// Of recordings and bags; captures have none.
    source: Option<SweepSource>,
    /// Wheels and gyroscope.
    pub aids: Aids,
    /// Revolutions, about.
    pub sweeps: u64,
    /// What the user should know about the input.
    pub notes: Vec<String>,
}

impl SpaceDrive {
    /// Looks at the files, which are all captures or all recordings.
    ///
    /// # Errors
    /// A file cannot be read, or has no lidar in it.
    pub fn open(files: &[PathBuf], choice: ModelChoice) -> anyhow::Result<Self> {
        let bags: Vec<bool> = files.iter().map(|file| is_bag(file)).collect::<Result<_, _>>()?;
        let mut drive = Self {
            files: files.to_vec(),
            choice,
            source: None,
            aids: Aids::default(),
            sweeps: 0,
            notes: Vec::new(),
        };
        if bags.iter().all(|is_bag| !is_bag) {
            drive.sweeps = count_sweeps(files);
            return Ok(drive);
        }
        if bags.contains(&false) {
            let what = "captures of the network and recordings have different clocks: map them one by one";
            return Err(BadInput(what.to_owned()).into());
        }
        let mut survey = SpaceSurvey::new(choice);
        for file in files {
            survey.read(file)?;
        }
        let name = files.first().map(|file| file.display().to_string()).unwrap_or_default();
        let found = survey.choose().map_err(|what| BadInput(format!("{name}: {what}")))?;
        drive.aids = Aids::new(found.aids, &found.frame, &mut drive.notes);
        (drive.source, drive.sweeps) = (Some(found.source), found.sweeps);
        Ok(drive)
    }

    /// Hands over the revolutions, one after the other, with what wheels and gyroscope say about each.
    ///
    /// # Errors
    /// A file that cannot be opened, or what `take` says.
    pub fn read(
        &self,
        take: &mut dyn FnMut(SweepRecord, MotionAid) -> anyhow::Result<()>,
    ) -> anyhow::Result<SweepsRead> {
        let mut read = SweepsRead::default();
        let mut cutter: Option<Cutter> = None;
        let mut before_s = None;
        let mut with_aid = |sweep: SweepRecord| {
            let start_s = before_s.unwrap_or(sweep.end_s - sweep.duration_s);
            let aid = self.aids.during(start_s, sweep.end_s);
            before_s = Some(sweep.end_s);
            take(sweep, aid)
        };
        for file in &self.files {
            read.ended = match &self.source {
                Some(source) => read_space_bag(file, source, (&mut cutter, &mut read), &mut with_aid)?,
                None => self.read_capture(file, &mut cutter, &mut read, &mut with_aid)?,
            };
            if read.ended.is_some() {
                break;
            }
        }
        if let Some(cutter) = cutter {
            cutter.finish(&mut read, &mut with_aid)?;
        }
        Ok(read)
    }

    fn read_capture(
        &self,
        file: &Path,
        cutter: &mut Option<Cutter>,
        read: &mut SweepsRead,
        take: &mut SweepSink<'_>,
    ) -> anyhow::Result<Option<String>> {
        let model = settle_model(file, self.choice)?;
        let cutter = match cutter {
            Some(cutter) if cutter.model() == model => cutter,
            other => other.insert(Cutter::new(model, 0)),
        };
        for datagram in Capture::open(file)? {
            let datagram = match datagram {
                Ok(datagram) => datagram,
                Err(error) => return Ok(Some(error.to_string())),
            };
            if datagram.destination_port == LIDAR_DATA_PORT {
                let arrival = Stamp::from_micros(datagram.captured_us);
                cutter.datagram((&datagram.payload, arrival), read, take)?;
            }
        }
        Ok(None)
    }
}

fn is_bag(file: &Path) -> Result<bool, BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", file.display()));
    must_be_a_file(file).map_err(bad)?;
    Ok(beginning(file, SNIFF_BYTES).map_err(bad)?.starts_with(MCAP_MAGIC))
}

/// Number of revolutions in captures, for the display of progress; 0 of what cannot be read.
fn count_sweeps(files: &[PathBuf]) -> u64 {
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
