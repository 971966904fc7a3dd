//! Logs that are text: laser logs, candump, tracks of people.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_host::packing;
use floorguard_recording::carmen::{CarmenLine, CarmenLog};
use floorguard_robot::environment::{TrackFormat, TrackReading, read_tracks};

use super::page::{Page, Stream};
use super::timeline::Timeline;
use floorguard_host::outcome::BadInput;

fn micros(time_s: f64) -> u64 {
    (time_s.max(0.0) * 1.0e6) as u64
}

/// A CARMEN log.
///
/// # Errors
/// It cannot be opened.
pub fn laser_log(file: &Path) -> anyhow::Result<Page> {
    let mut page = Page::new("a laser log (CARMEN)");
    let (mut scans, mut odometry, mut others) = (Timeline::default(), Timeline::default(), 0_u64);
    let (mut beams, mut posed) = (BTreeMap::<usize, u64>::new(), 0_u64);
    for line in CarmenLog::open(file).map_err(|error| BadInput(error.to_string()))? {
        match line {
            Ok(CarmenLine::Laser(scan)) => {
                scans.add(micros(scan.time_s));
                *beams.entry(scan.ranges_m.len()).or_default() += 1;
                posed += u64::from(scan.laser_in_odom.is_some());
            }
            Ok(CarmenLine::Odometry(_, _, time_s)) => odometry.add(micros(time_s)),
            Ok(CarmenLine::Other) => others += 1,
            Err(error) => page.faults.push(error.to_string()),
        }
    }
    let mut stream = Stream::new("scans", "FLASER, ROBOTLASER1 or RAWLASER1", &scans);
    stream.fields = beams.iter().map(|(beams, count)| format!("{count} of {beams} beams")).collect();
    stream.frame = (posed > 0).then(|| "odom".to_owned());
    if posed == 0 && scans.count() > 0 {
        stream.faults.push("no poses: people are in the frame of the scanner".to_owned());
    }
    page.streams.push(stream);
    page.streams.push(Stream::new("odometry", "ODOM", &odometry));
    page.streams.retain(|stream| stream.count > 0);
    if others > 0 {
        page.streams
            .push(Stream { count: others, ..Stream::new("other lines", "not read", &Timeline::default()) });
    }
    if scans.count() > 0 {
        page.commands.push("floorguard replay: legs and people in its scans".to_owned());
        page.commands.push("floorguard map: a map of the building by its scans".to_owned());
    }
    Ok(page)
}

/// A frame of a candump.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DumpedFrame {
    /// Microseconds, if the line says so.
    pub time_us: Option<u64>,
    /// 11 or 29 bits.
    pub identifier: u32,
    /// At most eight, 64 of CAN FD.
    pub bytes: Vec<u8>,
}

/// A line of a candump, in any of its forms.
pub fn can_frame(line: &str) -> Option<DumpedFrame> {
    let mut words = line.split_ascii_whitespace().peekable();
    let time = words.peek().and_then(|word| word.strip_prefix('(')?.strip_suffix(')')?.parse::<f64>().ok());
    if time.is_some() {
        words.next();
    }
    let _interface = words.next()?;
    let word = words.next()?;
    let byte = |digits: &str| u8::from_str_radix(digits, 16).ok();
    let (identifier, bytes) = match word.split_once('#') {
        Some((identifier, digits)) => {
            let pairs = (0..digits.len() / 2).map(|pair| digits.get(2 * pair..2 * pair + 2).and_then(byte));
            (identifier, pairs.collect::<Option<Vec<u8>>>()?)
        }
        None => {
            let count: usize = words.next()?.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?;
            (word, words.map_while(byte).take(count).collect())
        }
    };
    let identifier =
        u32::from_str_radix(identifier, 16).ok().filter(|_| matches!(identifier.len(), 3 | 8))?;
    Some(DumpedFrame { time_us: time.map(micros), identifier, bytes })
}

/// What a CANopen identifier is for (CiA 301, predefined connection set).
pub const fn can_service(identifier: u32) -> &'static str {
    match identifier {
        0 => "network management",
        0x80 => "synchronisation",
        0x81..=0xFF => "emergency",
        0x180..=0x57F => "process data",
        0x580..=0x67F => "service data",
        0x700..=0x77F => "heartbeat",
        _ => "other",
    }
}

/// Its first line is a frame.
pub fn is_candump(begins: &[u8]) -> bool {
    let sample = String::from_utf8_lossy(begins);
    let mut first = sample.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    first.next().is_some_and(|line| can_frame(line).is_some())
}

/// A candump, in any of its forms; `None` if its first lines are none.
///
/// # Errors
/// It cannot be read.
pub fn candump(file: &Path, begins: &[u8]) -> anyhow::Result<Option<Page>> {
    if !is_candump(begins) {
        return Ok(None);
    }
    let text = packing::text(file).map_err(|error| BadInput(format!("{}: {error}", file.display())))?;
    let mut page = Page::new("frames of a CAN bus (candump)");
    let mut services = BTreeMap::<&str, (Timeline, BTreeMap<u32, u64>)>::new();
    let (mut damaged, mut timed) = (0_u64, false);
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let Some(DumpedFrame { time_us, identifier, .. }) = can_frame(line) else {
            damaged += u64::from(!line.starts_with('#'));
            continue;
        };
        timed |= time_us.is_some();
        let (timeline, identifiers) = services.entry(can_service(identifier)).or_default();
        timeline.add(time_us.unwrap_or(number as u64));
        *identifiers.entry(identifier).or_default() += 1;
    }
    for (service, (timeline, identifiers)) in services {
        let mut stream = Stream::new(service, "CANopen", &timeline);
        // Frames of several devices share a microsecond, and heartbeats wait for nobody.
        stream.faults.retain(|fault| fault.contains("earlier"));
        if !timed {
            stream.times = super::timeline::Times::default();
        }
        stream.fields =
            identifiers.iter().map(|(identifier, count)| format!("{identifier:03X}h {count}")).collect();
        page.streams.push(stream);
    }
    if !timed {
        page.faults.push("no times: rates and timeouts cannot be judged".to_owned());
    }
    if damaged > 0 {
        page.faults.push(format!("{damaged} lines are no frames"));
    }
    page.commands.push("floorguard decode --csv: every frame as a row".to_owned());
    Ok(Some(page))
}

/// Tracks of people; `None` if they are none.
pub fn tracks(file: &Path) -> Option<Page> {
    let read = read_tracks(file, TrackReading { format: TrackFormat::Auto, frames_per_second: None }).ok()?;
    let mut timeline = Timeline::default();
    read.recording.moments.keys().for_each(|time_us| timeline.add(u64::try_from(*time_us).unwrap_or(0)));
    let mut page = Page::new("tracks of people");
    let mut stream = Stream::new("moments", format!("{:?}", read.format), &timeline);
    let points = read.recording.points().count();
    stream.fields = vec![format!("{} people", read.recording.people()), format!("{points} places")];
    if let Some((low, high)) = read.recording.bounds() {
        let place = format!("x {:.1} to {:.1} m, y {:.1} to {:.1} m", low.x_m, high.x_m, low.y_m, high.y_m);
        stream.fields.push(place);
    }
    page.streams.push(stream);
    page.commands.push("floorguard learn: where and when people walk".to_owned());
    Some(page)
}

/// The Edinburgh tracks, which are in pixels; `None` if they are none.
///
/// # Errors
/// It cannot be read.
pub fn pixel_tracks(file: &Path, begins: &[u8]) -> anyhow::Result<Option<Page>> {
    const TRACK: &str = "TRACK.R";
    if !String::from_utf8_lossy(begins).contains(TRACK) {
        return Ok(None);
    }
    let text = packing::text(file).map_err(|error| BadInput(format!("{}: {error}", file.display())))?;
    let tracks = text.lines().filter(|line| line.trim_start().starts_with(TRACK)).count() as u64;
    let mut page = Page::new("tracks of people in the pixels of a camera (Edinburgh)");
    page.streams
        .push(Stream { count: tracks, ..Stream::new("tracks", "pixels and frames", &Timeline::default()) });
    let what = "in pixels: turn them into metres by the camera's homography, and write time_s,id,x_m,y_m";
    page.faults.push(what.to_owned());
    Ok(Some(page))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_of_candump_is_read() {
        for (line, expected) in [
            ("can0  764   [1]  00", Some((None, 0x764, &[0_u8][..]))),
            ("(000.014403) RX 703 [2]  82 03", Some((Some(14_403), 0x703, &[0x82, 3]))),
            (
                "(1436509052.249713) vcan0 044#2A366C2BBA",
                Some((Some(1_436_509_052_249_713), 0x44, &[0x2A, 0x36, 0x6C, 0x2B, 0xBA])),
            ),
            ("FLASER 180 1.0 2.0", None),
            ("1 2 3 4", None),
        ] {
            let expected = expected.map(|(time_us, identifier, bytes)| DumpedFrame {
                time_us,
                identifier,
                bytes: bytes.to_vec(),
            });
            assert_eq!(can_frame(line), expected, "{line}");
        }
    }
}
