//! What was found, as a page and as JSON.

use std::fmt;

use serde::Serialize;

use super::timeline::{Timeline, Times};

/// One topic, device or kind of line.
#[derive(Debug, Serialize)]
pub struct Stream {
    /// Topic, port or word.
    pub name: String,
    /// What it is.
    pub kind: String,
    /// Messages, packets, scans.
    pub count: u64,
    /// Frame of its coordinates, where it says so.
    pub frame: Option<String>,
    /// Fields, models, sizes.
    pub fields: Vec<String>,
    /// Its times.
    pub times: Times,
    /// What is wrong.
    pub faults: Vec<String>,
}

impl Stream {
    /// With the faults of its times.
    pub fn new(name: impl Into<String>, kind: impl Into<String>, timeline: &Timeline) -> Self {
        Self::with_pauses(name, kind, (timeline, 0.0))
    }

    /// The same, where pauses of so many seconds are no fault.
    pub fn with_pauses(
        name: impl Into<String>,
        kind: impl Into<String>,
        (timeline, pauses_s): (&Timeline, f64),
    ) -> Self {
        let (times, count) = (timeline.times(), timeline.count());
        let faults = times.faults(count, pauses_s);
        Self { name: name.into(), kind: kind.into(), count, frame: None, fields: Vec::new(), times, faults }
    }
}

/// A recording.
#[derive(Debug, Serialize)]
pub struct Page {
    /// Its name.
    pub file: String,
    /// What it is.
    pub kind: String,
    /// Bytes of the file as it lies there.
    pub bytes: u64,
    /// What is in it.
    pub streams: Vec<Stream>,
    /// What is wrong with the whole.
    pub faults: Vec<String>,
    /// What we can do with it.
    pub commands: Vec<String>,
}

impl Page {
    /// Nothing known yet.
    pub fn new(kind: impl Into<String>) -> Self {
        Self {
            file: String::new(),
            kind: kind.into(),
            bytes: 0,
            streams: Vec::new(),
            faults: Vec::new(),
            commands: Vec::new(),
        }
    }

    /// Nothing is wrong with it.
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty() && self.streams.iter().all(|stream| stream.faults.is_empty())
    }
}

impl fmt::Display for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}, {} bytes", self.file, self.kind, self.bytes)?;
        for stream in &self.streams {
            let Stream { name, kind, count, frame, fields, times, faults } = stream;
            write!(f, "  {name} ({kind}): {count}")?;
            match (times.rate_hz, times.mean_rate_hz) {
                // Usually as often as in the mean: one number says it.
                (Some(rate_hz), Some(mean_hz)) if (mean_hz - rate_hz).abs() > 0.1 * rate_hz => {
                    write!(
                        f,
                        " in {:.1} s, {mean_hz:.1} Hz in the mean, mostly {rate_hz:.1} Hz",
                        times.duration_s
                    )?;
                }
                (Some(rate_hz), _) => write!(f, " in {:.1} s, {rate_hz:.1} Hz", times.duration_s)?,
                (None, _) => {}
            }
            if let Some(frame) = frame {
                write!(f, ", frame {frame:?}")?;
            }
            writeln!(f)?;
            if !fields.is_empty() {
                writeln!(f, "    {}", fields.join(", "))?;
            }
            faults.iter().try_for_each(|fault| writeln!(f, "    wrong: {fault}"))?;
        }
        self.faults.iter().try_for_each(|fault| writeln!(f, "  wrong: {fault}"))?;
        if self.is_sound() {
            writeln!(f, "  nothing is wrong with it")?;
        }
        match self.commands.as_slice() {
            [] => write!(f, "  no command takes it"),
            commands => write!(f, "  what you can do: {}", commands.join("; ")),
        }
    }
}
