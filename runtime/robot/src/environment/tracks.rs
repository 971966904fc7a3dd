//! Reads recorded tracks of people: the layouts of the ETH, L-CAS and HERMES recordings, and a plain table.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use floorguard_types::geometry::Point2;

use floorguard_host::packing;

/// How a file is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum TrackFormat {
    /// Tell from the first lines.
    #[default]
    Auto,
    /// Frame, id, x, z, y, and the velocity, metres; 15 frames a second.
    Eth,
    /// One JSON object a line, `{"track": {"f", "p", "x", "y"}}`, metres; 2.5 frames a second.
    Lcas,
    /// Id, frame, x, y, z, centimetres; 16 frames a second.
    Hermes,
    /// `time_s,id,x_m,y_m` with a heading.
    Csv,
}

impl TrackFormat {
    /// Frames a second; 1 where the file has seconds.
    #[must_use]
    pub const fn frames_per_second(self) -> f64 {
        match self {
            Self::Eth => 15.0,
            Self::Lcas => 2.5,
            Self::Hermes => 16.0,
            Self::Auto | Self::Csv => 1.0,
        }
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

/// Reads a file, packed or not.
///
/// # Errors
/// A file that cannot be read, a layout that is not known, a line that does not fit, no tracks at all.
pub fn read_tracks(path: &Path, format: TrackFormat) -> anyhow::Result<(Recording, TrackFormat)> {
    let name = path.display();
    let text = packing::text(path).with_context(|| format!("{name}: cannot be read"))?;
    let format =
        if format == TrackFormat::Auto { guess(&text).with_context(|| format!("{name}"))? } else { format };
    let recording = parse(&text, format).with_context(|| format!("{name}"))?;
    ensure!(!recording.moments.is_empty(), "{name}: no tracks in it");
    Ok((recording, format))
}

fn guess(text: &str) -> anyhow::Result<TrackFormat> {
    let line =
        text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).context("it is empty")?;
    let columns = line.split_whitespace().count();
    Ok(match line.trim_start().chars().next() {
        Some('{') => TrackFormat::Lcas,
        _ if line.contains(',') => TrackFormat::Csv,
        _ if columns == 8 => TrackFormat::Eth,
        _ if columns == 5 => TrackFormat::Hermes,
        _ => bail!("no layout of tracks that is known; choose one with --format"),
    })
}

/// Frame or seconds, id, position.
type Row = (f64, u64, Point2);

fn parse(text: &str, format: TrackFormat) -> anyhow::Result<Recording> {
    let mut rows: Vec<Row> = Vec::new();
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
    let first = rows.iter().map(|row| row.0).fold(f64::INFINITY, f64::min);
    let mut recording = Recording::default();
    for (frame, id, position) in rows {
        let micros = (frame - first) / format.frames_per_second() * 1.0e6;
        ensure!((0.0..1.0e15).contains(&micros), "frame {frame} lies too far from the first");
        recording.moments.entry(micros.round() as i64).or_default().push(TrackPoint { id, position });
    }
    recording.moments.values_mut().for_each(|points| points.sort_by_key(|point| point.id));
    Ok(recording)
}

fn checked(frame: f64, id: f64, x_m: f64, y_m: f64) -> anyhow::Result<Row> {
    ensure!([frame, id, x_m, y_m].iter().all(|value| value.is_finite()), "a number is not finite");
    ensure!((0.0..9.0e15).contains(&id), "the id {id} is out of range");
    ensure!(x_m.abs() < 1.0e5 && y_m.abs() < 1.0e5, "the position {x_m}, {y_m} is out of range");
    Ok((frame, id as u64, Point2::new(x_m as f32, y_m as f32)))
}

fn number_row(line: &str, format: TrackFormat) -> anyhow::Result<Row> {
    let separators = |character: char| character == ',' || character.is_whitespace();
    let fields = line.split(separators).filter(|field| !field.is_empty());
    let numbers: Vec<f64> = fields
        .map(|field| field.parse::<f64>().with_context(|| format!("'{field}' is not a number")))
        .collect::<anyhow::Result<_>>()?;
    match (format, numbers.as_slice()) {
        (TrackFormat::Eth, [frame, id, x, _, y, ..]) => checked(*frame, *id, *x, *y),
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
        let recording = parse(text, guessed).unwrap();
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
        let csv = "time_s,id,x_m,y_m\n10.5,3,1,2\n11,3,1.5,2\n";
        assert_eq!(point(csv, TrackFormat::Csv), (500_000, 3, 1.5, 2.0));
    }

    #[test]
    fn says_which_line_is_wrong() {
        let error =
            parse("1 84 154.0 679.0 175.4\n1 x 150.0 650.0 175.4\n", TrackFormat::Hermes).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error:#}");
        assert!(parse("{\"track\": {\"f\": 0}}", TrackFormat::Lcas).is_err());
        assert!(parse("1 2 nan 4 5", TrackFormat::Hermes).is_err());
        assert!(guess("a b c").is_err() && guess("\n\n").is_err());
    }
}
