//! Stages of the robot against keys, as a table or as JSON.

use std::path::PathBuf;

use clap::Subcommand;
use floorguard_perception::motion::MotionParameters;
use serde::Serialize;

use floorguard_host::outcome::VerdictFailed;
use floorguard_laboratory::evaluate;

/// A stage and its files.
#[derive(Clone, Debug, Subcommand)]
pub enum RecordedStage {
    /// Decision values of a libsvm model against what libsvm computed for the same rows.
    #[command(
        after_help = "Example:\n  floorguard eval svm --model people.model --range people.range --rows rows.csv.gz"
    )]
    Svm {
        /// The model: C-SVC with a radial kernel, two classes.
        #[arg(long)]
        model: PathBuf,
        /// Bounds of its features, as svm-scale writes them.
        #[arg(long)]
        range: PathBuf,
        /// Label, decision value, probability of label 1, scaled features; .csv or .csv.gz.
        #[arg(long)]
        rows: PathBuf,
    },
    /// Which objects move, in a recording of a lidar that stands still, against a key of walking people.
    #[command(after_help = "Example:\n  floorguard eval motion hall.pcap.gz --key hall.csv")]
    Motion {
        /// The capture: .pcap, .pcapng, either of them .gz; a lidar of 16 rings.
        recording: PathBuf,
        /// Who was where: rows of frame, time_s, track, x, y, named in the first line.
        #[arg(long)]
        key: PathBuf,
    },
    /// One person in the scans of a two-dimensional scanner that may move: seen, followed, confirmed.
    #[command(after_help = "Example:\n  floorguard eval walker --scans scans.csv --truth person.csv")]
    Walker {
        /// Lines of bag time (ns), time (s) and ranges, blank where nothing returned; the first line names the geometry.
        #[arg(long)]
        scans: PathBuf,
        /// Lines of bag time (ns), id, x and y in the frame of the sensor. Without it every confirmed person counts as
        /// another one.
        #[arg(long)]
        truth: Option<PathBuf>,
    },
    /// Legs in labelled scans: each recording tested with a committee that learnt from the others.
    #[command(after_help = "Example:\n  floorguard eval legs --scans scans.csv --out pictures")]
    Legs {
        /// Lines of source, scan, number of legs, legs `x:y;x:y`, ranges; the first line names the geometry.
        #[arg(long)]
        scans: PathBuf,
        /// Test the table of this build instead of learning anew.
        #[arg(long)]
        table: bool,
        /// Folder for the picture of precision over recall, `legs_precision_recall.svg`.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// People claimed in a capture of a standing VLP-16 against a key of where people stood.
    #[command(after_help = "Example:\n  floorguard eval clusters hall.pcap --key people.csv")]
    Clusters {
        /// The capture; a list `NAME.frames.csv` beside it is used where there is one.
        file: PathBuf,
        /// Where people stood: columns `frame`, and `x`, `y` or `cx`, `cy`.
        #[arg(long)]
        key: PathBuf,
    },
    /// Objects taken for people in a capture of a standing VLP-16: in the first second, and after ten.
    #[command(after_help = "Example:\n  floorguard eval people hall.pcap --key people.csv")]
    People {
        /// The capture; a list `NAME.frames.csv` beside it is used where there is one.
        file: PathBuf,
        /// Who was where: rows of frame, time_s, track, x, y, named in the first line. Without it the place was empty.
        #[arg(long)]
        key: Option<PathBuf>,
        /// Play it forth and back for so many minutes: who stands for long must stay a person.
        #[arg(long, default_value_t = 0.0)]
        minutes: f32,
    },
    /// CLEAR-MOT figures of two files in the MOT15 format, rectangles paired from an overlap of one half.
    #[command(after_help = "Example:\n  floorguard eval tracks --truth truth.txt --result result.txt")]
    Tracks {
        /// What was there.
        #[arg(long)]
        truth: PathBuf,
        /// The tracker's output.
        #[arg(long)]
        result: PathBuf,
    },
    /// Dirt in a folder of frames with masks: the published detector and ours.
    #[command(after_help = "Example:\n  floorguard eval dirt frames --out pictures")]
    Dirt {
        /// NAME.png or .jpg with NAME_mask.png; NAME_floor.png and NAME_laser.png if there are.
        folder: PathBuf,
        /// A folder for pictures: truth, published, ours.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// The floor of a depth picture: plane, mask and objects.
    #[command(
        after_help = "Example:\n  floorguard eval floor --depth depth.png --intrinsics 525,525,319.5,239.5 --out pictures"
    )]
    Floor {
        /// Depth in millimetres, one channel of 16 bits.
        #[arg(long)]
        depth: PathBuf,
        /// Focal lengths and principal point in pixels: fx,fy,cx,cy.
        #[arg(long, value_parser = evaluate::parse_intrinsics)]
        intrinsics: [f32; 4],
        /// A mask of the floor to compare with.
        #[arg(long)]
        truth: Option<PathBuf>,
        /// Height of the camera in metres, if known.
        #[arg(long, requires = "pitch_deg")]
        height_m: Option<f32>,
        /// How far the camera looks down, in degrees, if known.
        #[arg(long, requires = "height_m", allow_hyphen_values = true)]
        pitch_deg: Option<f32>,
        /// A folder for a picture: floor green, objects red, holes blue.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// People in depth pictures: upper bodies by their silhouette, legs near the camera.
    #[command(
        after_help = "Example:\n  floorguard eval rgbd-people --depth depth.png --intrinsics 525,525,319.5,239.5 --out pictures"
    )]
    RgbdPeople {
        /// Depth in millimetres, one channel of 16 bits; once or more often.
        #[arg(long, required = true, num_args = 1..)]
        depth: Vec<PathBuf>,
        /// Colour pictures of the same size and view, one for each depth picture, in the same order.
        #[arg(long, alias = "color", num_args = 1..)]
        colour: Vec<PathBuf>,
        /// Focal lengths and principal point in pixels: fx,fy,cx,cy.
        #[arg(long, value_parser = evaluate::parse_intrinsics)]
        intrinsics: [f32; 4],
        /// Height of the camera in metres, if known.
        #[arg(long, requires = "pitch_deg")]
        height_m: Option<f32>,
        /// How far the camera looks down, in degrees, if known.
        #[arg(long, requires = "height_m", allow_hyphen_values = true)]
        pitch_deg: Option<f32>,
        /// Who stood where: columns `file`, `x`, `y`, metres ahead and to the left of the camera.
        #[arg(long)]
        key: Option<PathBuf>,
        /// A folder for pictures: upper bodies yellow, both green, legs blue.
        #[arg(long)]
        out: Option<PathBuf>,
    },
}

/// Evaluates a stage.
///
/// # Errors
/// Bad input, or a verdict that is not good enough.
pub(super) fn run(stage: &RecordedStage, json: bool) -> anyhow::Result<()> {
    match stage {
        RecordedStage::Svm { model, range, rows } => {
            let report = evaluate::svm(model, range, rows)?;
            print(&report, json)?;
            judge(report.passed(), "labels or decision values differ from the key")
        }
        RecordedStage::Motion { recording, key } => {
            let report = evaluate::motion(recording, key, MotionParameters::FIXED)?;
            print(&report, json)
        }
        RecordedStage::Legs { scans, table, out } => {
            let report = evaluate::legs(scans, *table)?;
            if let Some(folder) = out {
                evaluate::draw_legs(folder, &report)?;
            }
            print(&report, json)
        }
        RecordedStage::Walker { scans, truth } => print(&evaluate::walker(scans, truth.as_deref())?, json),
        RecordedStage::Clusters { file, key } => print(&evaluate::clusters(file, key)?, json),
        RecordedStage::People { file, key, minutes } => {
            print(&evaluate::false_people(file, key.as_deref(), *minutes)?, json)
        }
        RecordedStage::Dirt { folder, out } => print(&evaluate::dirt(folder, out.as_deref())?, json),
        RecordedStage::Floor { depth, intrinsics, truth, height_m, pitch_deg, out } => {
            let mounting = height_m.zip(*pitch_deg).map(|(height, pitch)| [height, pitch.to_radians()]);
            let task = evaluate::FloorTask {
                depth: depth.clone(),
                intrinsics: *intrinsics,
                truth: truth.clone(),
                mounting,
                out: out.clone(),
            };
            print(&evaluate::floor(&task)?, json)
        }
        RecordedStage::RgbdPeople { depth, colour, intrinsics, height_m, pitch_deg, key, out } => {
            let mounting = height_m.zip(*pitch_deg).map(|(height, pitch)| [height, pitch.to_radians()]);
            let task = evaluate::RgbdTask {
                depths: depth.clone(),
                colours: colour.clone(),
                intrinsics: *intrinsics,
                mounting,
                key: key.clone(),
                out: out.clone(),
            };
            print(&evaluate::rgbd_people(&task)?, json)
        }
        RecordedStage::Tracks { truth, result } => print(&evaluate::tracks(truth, result)?, json),
    }
}

/// Exit code 1 with a reason where a verdict is not good enough.
fn judge(passed: bool, reason: &str) -> anyhow::Result<()> {
    if passed { Ok(()) } else { Err(VerdictFailed(reason.to_owned()).into()) }
}

/// A report on standard output: one JSON object, or one line a figure.
fn print(report: &impl Serialize, json: bool) -> anyhow::Result<()> {
    let value = serde_json::to_value(report)?;
    if json {
        tell!("{value}")?;
        return Ok(());
    }
    for (name, figure) in value.as_object().into_iter().flatten() {
        tell!("{name:28} {figure}")?;
    }
    Ok(())
}
