//! Runs the command.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use floorguard_detector::{
    Detector, DetectorConfig, DetectorThread, Found, OnnxModel, RgbPicture, WorkerCounts,
};
use floorguard_host::outcome::BadInput;
use floorguard_mapping::people_removal::PersonBox;
use floorguard_types::time::{Age, Stamp};
use serde_json::{Value, json};

use super::pictures::{TakenPicture, for_each_picture};
use crate::files::write_whole;

/// What to look for people in.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples: floorguard detect-people yolox_s.onnx drive.mcap --out people.json\n          floorguard detect-people yolo11n.onnx pictures/ --out people.json"
)]
pub struct DetectArguments {
    /// A detector with the output of YOLOX (raw, not decoded), YOLOv8 or YOLO11 (.onnx); the licence of its weights is yours to
    /// check.
    pub model: PathBuf,
    /// A folder of PNG or JPEG files whose names end in the time of the picture, or a ROS 2 bag with CompressedImage or Image
    /// (.mcap).
    pub pictures: PathBuf,
    /// The boxes, for `clean-map --boxes` (JSON).
    #[arg(long, value_name = "FILE.json")]
    pub out: PathBuf,
    /// Number of the class that is a person; 0 in detectors of COCO's 80 classes.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub class: usize,
    /// Boxes with a lower score are left out, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.3)]
    pub score: f32,
    /// Play the pictures as fast as they were taken, to a detector on a thread of its own: what it is too slow for is dropped and
    /// counted, as on a robot.
    #[arg(long)]
    pub paced: bool,
    /// The counts as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// A file that is no model or no pictures, or a model that fails.
pub fn run(arguments: &DetectArguments) -> anyhow::Result<()> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", arguments.model.display()));
    let model = OnnxModel::load(&arguments.model).map_err(|error| bad(&error))?;
    let config =
        DetectorConfig { class: arguments.class, score_min: arguments.score, ..DetectorConfig::default() };
    let mut detector = Detector::new(Box::new(model), config).map_err(|error| bad(&error))?;
    let layout = detector.layout();
    let began = Instant::now();
    let (found, counts) = if arguments.paced {
        paced(arguments, detector)?
    } else {
        let mut found = Vec::new();
        for_each_picture(&arguments.pictures, &mut |taken| {
            let (stamp, picture) = rgb(taken)?;
            let people = detector.detect(&picture).map_err(|error| bad(&error))?;
            found.push(Found { stamp, size: picture.size(), people: Ok(people) });
            Ok(())
        })?;
        let processed = found.len() as u64;
        (found, WorkerCounts { offered: processed, processed, ..WorkerCounts::default() })
    };
    let mut images = Vec::new();
    for each in found {
        images.push(row(&each).map_err(|error| bad(&error))?);
    }
    let ms = 1.0e3 * began.elapsed().as_secs_f64() / counts.processed.max(1) as f64;
    write_whole(&arguments.out, (json!({ "images": images }).to_string() + "\n").as_bytes())?;
    let people: usize = images.iter().filter_map(|image| image["boxes"].as_array()).map(Vec::len).sum();
    if arguments.json {
        let (offered, processed, late) = (counts.offered, counts.processed, counts.late);
        let row = json!({
            "pictures": offered, "processed": processed, "late": late, "not_taken": counts.not_taken, "people": people,
            "ms_per_picture": ms,
        });
        return Ok(tell!("{row}")?);
    }
    say!("found: {} ({layout:?}, {people} boxes)", arguments.out.display());
    say!(
        "  {} pictures, {} looked at, {} too late; {ms:.0} ms each",
        counts.offered,
        counts.processed,
        counts.late
    );
    Ok(())
}

/// Waits between pictures as long as the camera did.
fn paced(arguments: &DetectArguments, detector: Detector) -> anyhow::Result<(Vec<Found>, WorkerCounts)> {
    let thread = DetectorThread::start(detector)?;
    let (began, mut first) = (Instant::now(), None::<Stamp>);
    let mut found = Vec::new();
    for_each_picture(&arguments.pictures, &mut |taken| {
        let (stamp, picture) = rgb(taken)?;
        let first = *first.get_or_insert(stamp);
        if let Age::Past(age_us) = first.age(stamp) {
            std::thread::sleep(Duration::from_micros(age_us).saturating_sub(began.elapsed()));
        }
        thread.offer(stamp, picture);
        found.extend(std::iter::from_fn(|| thread.take()));
        Ok(())
    })?;
    let (last, counts) = thread.finish();
    found.extend(last);
    Ok((found, counts))
}

fn rgb(taken: TakenPicture) -> anyhow::Result<(Stamp, RgbPicture)> {
    let size = taken.size;
    Ok((taken.stamp, RgbPicture::new(size, taken.rgb).map_err(|error| BadInput(error.to_string()))?))
}

fn row(found: &Found) -> Result<Value, String> {
    let people = found.people.as_ref().map_err(Clone::clone)?;
    let edges = |person: &PersonBox| {
        let (first, last) = (person.upper_left, person.lower_right);
        let edges = [first.column, first.row, last.column, last.row];
        json!({ "class": "person", "score": person.confidence, "box": edges })
    };
    Ok(json!({
        "time_s": found.stamp.as_micros() as f64 * 1.0e-6,
        "width": found.size[0],
        "height": found.size[1],
        "boxes": people.iter().map(edges).collect::<Vec<_>>(),
    }))
}
