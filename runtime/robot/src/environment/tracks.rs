//! Reads recorded tracks of people: the layouts of the ETH, L-CAS and HERMES recordings, plain tables and JSON.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use floorguard_types::geometry::Point2;

use floorguard_host::packing;

use super::tracks_named::{self, NamedRows};

/// How a file is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum TrackFormat {
    /// Tell from the first lines.
    #[default]
    Auto,
    /// Frame, id, x, z, y, and the velocity, metres; the velocities tell how many frames a second, 15 where they do not.
    Eth,
    /// Frame, id, x, y, metres, as the usual test files of ETH and UCY: 0.4 s between annotated frames.
    EthUcy,
    /// One JSON object a line, `{"track": {"f", "p", "x", "y"}}`, metres; 2.5 frames a second.
    Lcas,
    /// Id, frame, x, y, z, centimetres; 16 frames a second.
    Hermes,
    /// Seconds, id, x, y, metres, separated by commas.
    Csv,
    /// A table whose heading names its columns, as OpenTraj writes it: `timestamp` or `frame_id`, `agent_id`, `pos_x`, `pos_y`;
    /// or `time_s`, `id`, `x_m`, `y_m`; metres. Frames need `--rate`.
    Table,
    /// JSON objects with these names, in a list or one a line, or people with a list of points each; metres.
    Json,
}

impl TrackFormat {
    /// Frames a second where the file tells nothing else; 1 where the file has seconds.
    #[must_use]
    pub const fn frames_per_second(self) -> f64 {
        match self {
            Self::Eth => 15.0,
            Self::EthUcy => 25.0,
            Self::Lcas => 2.5,
            Self::Hermes => 16.0,
            Self::Auto | Self::Csv | Self::Table | Self::Json => 1.0,
        }
    }

    /// Moments are frames, whatever the file tells.
    const fn in_frames(self) -> bool {
        matches!(self, Self::Eth | Self::EthUcy | Self::Lcas | Self::Hermes)
    }
}

/// A person at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// The track.
    pub id: u64,
    /// Where, in the frame of the recording.
    pub position: Point2,
}

/// A recording: moments in order.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// By microseconds since the first moment.
    pub moments: BTreeMap<i64, Vec<TrackPoint>>,
}

impl Recording {
    /// Length, µs.
    #[must_use]
    pub fn length_us(&self) -> i64 {
        self.moments.keys().last().copied().unwrap_or(0)
    }

    /// Number of tracks.
    #[must_use]
    pub fn people(&self) -> usize {
        let ids: std::collections::BTreeSet<u64> = self.points().map(|point| point.id).collect();
        ids.len()
    }

    /// All points.
    pub fn points(&self) -> impl Iterator<Item = &TrackPoint> {
        self.moments.values().flatten()
    }

    /// Smallest and largest coordinates.
    #[must_use]
    pub fn bounds(&self) -> Option<(Point2, Point2)> {
        let mut points = self.points().map(|point| point.position);
        let first = points.next()?;
        Some(points.fold((first, first), |(low, high), point| {
            (
                Point2::new(low.x_m.min(point.x_m), low.y_m.min(point.y_m)),
                Point2::new(high.x_m.max(point.x_m), high.y_m.max(point.y_m)),
            )
        }))
    }
}

/// How a file is to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackReading {
    /// Its layout.
    pub format: TrackFormat,
    /// Frames a second; without it, what the file tells or its layout is known for.
    pub frames_per_second: Option<f64>,
}

/// What was read.
#[derive(Clone, Debug)]
pub struct ReadTracks {
    /// The tracks.
    pub recording: Recording,
    /// Their layout.
    pub format: TrackFormat,
    /// Frames a second that were used.
    pub frames_per_second: f64,
}

/// Reads a file, packed or not.
///
/// # Errors
/// A file that cannot be read, a layout that is not known, a line that does not fit, no tracks at all, a rate that is not
/// within 0.1 to 1,000 frames a second or given for a file that has seconds.
pub fn read_tracks(path: &Path, reading: TrackReading) -> anyhow::Result<ReadTracks> {
    let name = path.display();
    let text = packing::text(path).with_context(|| format!("{name}: cannot be read"))?;
    let TrackReading { format, frames_per_second } = reading;
    let format =
        if format == TrackFormat::Auto { guess(&text).with_context(|| format!("{name}"))? } else { format };
    let NamedRows { rows, in_frames } = match format {
        TrackFormat::Table => tracks_named::table(&text),
        TrackFormat::Json => tracks_named::json(&text),
        _ => rows(&text, format).map(|rows| NamedRows { rows, in_frames: format.in_frames() }),
    }
    .with_context(|| format!("{name}"))?;
    match frames_per_second {
        Some(rate) => {
            ensure!(in_frames, "{name}: it has seconds; leave --rate out");
            ensure!((0.1..=1_000.0).contains(&rate), "--rate {rate}: give 0.1 to 1000 frames a second");
        }
        None => ensure!(
            !in_frames || format.in_frames(),
            "{name}: it counts frames and does not tell how many a second: give --rate"
        ),
    }
    let frames_per_second = frames_per_second.unwrap_or_else(|| frame_rate(&rows, format));
    let recording = recording(&rows, frames_per_second).with_context(|| format!("{name}"))?;
    ensure!(!recording.moments.is_empty(), "{name}: no tracks in it");
    Ok(ReadTracks { recording, format, frames_per_second })
}

fn guess(text: &str) -> anyhow::Result<TrackFormat> {
    let line =
        text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).context("it is empty")?;
    let columns = line.split_whitespace().count();
    Ok(match line.trim_start().chars().next() {
        Some('{') if is_lcas(line) => TrackFormat::Lcas,
        Some('{' | '[') => TrackFormat::Json,
        _ if tracks_named::is_heading(line) => TrackFormat::Table,
        _ if line.contains(',') => TrackFormat::Csv,
        _ if columns == 8 => TrackFormat::Eth,
        _ if columns == 5 => TrackFormat::Hermes,
        _ if columns == 4 => TrackFormat::EthUcy,
        _ => bail!("no layout of tracks that is known; choose one with --format"),
    })
}

/// A line of the L-CAS layout: a scene, or a track with its own object of values.
fn is_lcas(line: &str) -> bool {
    let object: Option<serde_json::Value> = serde_json::from_str(line).ok();
    object.is_some_and(|object| {
        ["scene", "track"].iter().any(|key| object.get(key).is_some_and(|of| of.is_object()))
    })
}

/// One line of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Frame, or seconds.
    pub frame: f64,
    pub id: u64,
    pub position: Point2,
    /// Metres a second, where the layout has it.
    pub speed_mps: Option<f64>,
}

fn rows(text: &str, format: TrackFormat) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let row = match format {
            TrackFormat::Lcas => json_row(line),
            _ => number_row(line, format).map(Some),
        };
        match row {
            Ok(Some(row)) => rows.push(row),
            Ok(None) => {}
            Err(_) if number == 0 && format == TrackFormat::Csv => {}
            Err(error) => bail!("line {}: {error:#}", number + 1),
        }
    }
    Ok(rows)
}

/// Steps shorter than this tell nothing of the rate, metres.
const STEP_M: f64 = 0.1;
/// Steps from which a rate is taken.
const STEPS_MIN: usize = 20;
/// Seconds between annotated frames in the usual test files of ETH and UCY (Pellegrini et al. 2009, Lerner et al. 2007).
const ETH_UCY_STEP_S: f64 = 0.4;

/// Frames a second: from the velocities if the file has them, from the step between annotated frames in a file of the ETH
/// and UCY sets, else what the layout is known for.
fn frame_rate(rows: &[Row], format: TrackFormat) -> f64 {
    let reported = match format {
        TrackFormat::Eth => rate_of_velocities(rows),
        TrackFormat::EthUcy => rate_of_steps(rows),
        _ => None,
    };
    reported.unwrap_or(format.frames_per_second())
}

/// The same person in two successive rows, in the order of the frames.
fn successive(rows: &[Row]) -> Vec<[Row; 2]> {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.id.cmp(&b.id).then(a.frame.total_cmp(&b.frame)));
    sorted.array_windows().filter(|[a, b]| a.id == b.id && a.frame < b.frame).copied().collect()
}

fn rate_of_velocities(rows: &[Row]) -> Option<f64> {
    let rate = |[a, b]: [Row; 2]| {
        let step_m =
            f64::from(libm::hypotf(b.position.x_m - a.position.x_m, b.position.y_m - a.position.y_m));
        let speed_mps = 0.5 * (a.speed_mps? + b.speed_mps?);
        (step_m > STEP_M).then(|| speed_mps * (b.frame - a.frame) / step_m)
    };
    let mut rates: Vec<f64> = successive(rows).into_iter().filter_map(rate).collect();
    rates.sort_by(f64::total_cmp);
    let median = *rates.get(rates.len() / 2).filter(|_| rates.len() >= STEPS_MIN)?;
    (0.5..1_000.0).contains(&median).then(|| median.round().max(1.0))
}

fn rate_of_steps(rows: &[Row]) -> Option<f64> {
    let steps = successive(rows).into_iter().map(|[a, b]| b.frame - a.frame);
    steps.reduce(f64::min).map(|frames| frames / ETH_UCY_STEP_S)
}

fn recording(rows: &[Row], frames_per_second: f64) -> anyhow::Result<Recording> {
    let first = rows.iter().map(|row| row.frame).fold(f64::INFINITY, f64::min);
    let mut recording = Recording::default();
    for Row { frame, id, position, .. } in rows {
        let micros = (frame - first) / frames_per_second * 1.0e6;
        ensure!((0.0..1.0e15).contains(&micros), "frame {frame} lies too far from the first");
        let point = TrackPoint { id: *id, position: *position };
        recording.moments.entry(micros.round() as i64).or_default().push(point);
    }
    recording.moments.values_mut().for_each(|points| points.sort_by_key(|point| point.id));
    Ok(recording)
}

/// A row within sane limits.
pub(super) fn checked(frame: f64, id: f64, x_m: f64, y_m: f64) -> anyhow::Result<Row> {
    ensure!([frame, id, x_m, y_m].iter().all(|value| value.is_finite()), "a number is not finite");
    ensure!((0.0..9.0e15).contains(&id), "the id {id} is out of range");
    ensure!(x_m.abs() < 1.0e5 && y_m.abs() < 1.0e5, "the position {x_m}, {y_m} is out of range");
    let position = Point2::new(x_m as f32, y_m as f32);
    Ok(Row { frame, id: id as u64, position, speed_mps: None })
}

fn number_row(line: &str, format: TrackFormat) -> anyhow::Result<Row> {
    let separators = |character: char| character == ',' || character.is_whitespace();
    let fields = line.split(separators).filter(|field| !field.is_empty());
    let numbers: Vec<f64> = fields
        .map(|field| field.parse::<f64>().with_context(|| format!("'{field}' is not a number")))
        .collect::<anyhow::Result<_>>()?;
    match (format, numbers.as_slice()) {
        (TrackFormat::Eth, [frame, id, x, _, y, velocity @ ..]) => {
            let speed_mps = match velocity {
                [vx, _, vy, ..] => Some(libm::hypot(*vx, *vy)).filter(|speed| speed.is_finite()),
                _ => None,
            };
            Ok(Row { speed_mps, ..checked(*frame, *id, *x, *y)? })
        }
        (TrackFormat::EthUcy, [frame, id, x, y, ..]) => checked(*frame, *id, *x, *y),
        (TrackFormat::Hermes, [id, frame, x, y, ..]) => checked(*frame, *id, x / 100.0, y / 100.0),
        (TrackFormat::Csv, [seconds, id, x, y, ..]) => checked(*seconds, *id, *x, *y),
        _ => bail!("{} columns are too few", numbers.len()),
    }
}

fn json_row(line: &str) -> anyhow::Result<Option<Row>> {
    let object: serde_json::Value = serde_json::from_str(line).context("this is no JSON object")?;
    let Some(track) = object.get("track") else { return Ok(None) };
    let number =
        |key: &str| track.get(key).and_then(serde_json::Value::as_f64).with_context(|| format!("no '{key}'"));
    checked(number("f")?, number("p")?, number("x")?, number("y")?).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(text: &str, format: TrackFormat) -> (i64, u64, f32, f32) {
        let guessed = guess(text).unwrap();
        assert_eq!(guessed, format);
        let rows = rows(text, guessed).unwrap();
        let recording = recording(&rows, frame_rate(&rows, guessed)).unwrap();
        let (at, points) = recording.moments.last_key_value().unwrap();
        (*at, points[0].id, points[0].position.x_m, points[0].position.y_m)
    }

    #[test]
    fn reads_each_layout() {
        let eth = "7.80e+02 1.0 8.4 0.0 3.5 1.6 0.0 0.1\n7.86e+02 1.0 9.1 0.0 3.6 1.6 0.0 0.3\n";
        assert_eq!(point(eth, TrackFormat::Eth), (400_000, 1, 9.1, 3.6));
        let lcas = "{\"scene\": {\"id\": 1}}\n{\"track\": {\"f\": 0, \"p\": 5, \"x\": 1, \"y\": 2}}\n\
                    {\"track\": {\"f\": 1, \"p\": 5, \"x\": 1.5, \"y\": -2}}\n";
        assert_eq!(point(lcas, TrackFormat::Lcas), (400_000, 5, 1.5, -2.0));
        let hermes = "1 84 154.0 679.0 175.4\n1 100 150.0 650.0 175.4\n";
        assert_eq!(point(hermes, TrackFormat::Hermes), (1_000_000, 1, 1.5, 6.5));
        let csv = "10.5,3,1,2\n11,3,1.5,2\n";
        assert_eq!(point(csv, TrackFormat::Csv), (500_000, 3, 1.5, 2.0));
    }

    #[test]
    fn error_names_the_wrong_line() {
        let error = rows("1 84 154.0 679.0 175.4\n1 x 150.0 650.0 175.4\n", TrackFormat::Hermes).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error:#}");
        assert!(rows("{\"track\": {\"f\": 0}}", TrackFormat::Lcas).is_err());
        assert!(rows("1 2 nan 4 5", TrackFormat::Hermes).is_err());
        let named = "{\"track\": 3, \"id\": 3, \"t\": 0, \"x\": 1, \"y\": 2}";
        assert_eq!(guess(named).unwrap(), TrackFormat::Json);
        assert!(guess("a b c").is_err() && guess("\n\n").is_err());
    }

    /// A person who walks at 1.3 m/s, annotated every ten frames of a film with `rate` frames a second.
    fn walk(rate: f64) -> String {
        (0..40)
            .map(|step| {
                let seconds = 10.0 * f64::from(step) / rate;
                format!("{} 7 {} 0 2.0 1.3 0 0\n", 100 + 10 * step, 1.3 * seconds)
            })
            .collect()
    }

    #[test]
    fn velocities_tell_the_frame_rate() {
        for rate in [15.0, 25.0, 30.0] {
            let rows = rows(&walk(rate), TrackFormat::Eth).unwrap();
            assert_eq!(frame_rate(&rows, TrackFormat::Eth), rate);
        }
    }

    #[test]
    fn annotated_steps_tell_the_frame_rate() {
        let text = "780 1 8.46 3.59\n790 1 9.57 3.79\n800 1 10.67 3.99\n";
        assert_eq!(guess(text).unwrap(), TrackFormat::EthUcy);
        let rows = rows(text, TrackFormat::EthUcy).unwrap();
        assert_eq!(frame_rate(&rows, TrackFormat::EthUcy), 25.0);
        assert_eq!(recording(&rows, 25.0).unwrap().length_us(), 800_000);
    }
}
