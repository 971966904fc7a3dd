//! A lidar capture cut into the frames of its key.
//!
//! A file `NAME.frames.csv` beside the capture says which packets make which frame. Without it a frame is as many
//! packets as a revolution needs, rounded up, as the usual driver publishes them.

use std::path::{Path, PathBuf};

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::people::{FloorHeight, RingAngles, SweepContext};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use floorguard_host::outcome::BadInput;
use floorguard_recording::capture::settle_model;
use floorguard_recording::capture::{Capture, Datagram};
use floorguard_robot::picture_files::read_text;

/// UDP port of lidar data.
const PORT: u16 = 2_368;
/// Height assumed where no floor is seen, metres (the FLOBOT layout).
const ASSUMED_HEIGHT_M: f32 = 0.8;

/// The sweeps of a VLP-16 capture, one per frame of its key.
///
/// # Errors
/// The capture is broken or empty, or the list of frames does not fit it.
pub fn capture_frames(capture: &Path) -> anyhow::Result<Vec<Box<Sweep>>> {
    let model = settle_model(capture, ModelChoice::Auto)?;
    if model != Model::Vlp16 {
        let reason = format!("{}: this is a {}; clusters knows the VLP-16", capture.display(), model.name());
        return Err(BadInput(reason).into());
    }
    let mut datagrams = Vec::new();
    for datagram in Capture::open(capture)? {
        let datagram = datagram?;
        if datagram.destination_port == PORT {
            datagrams.push(datagram);
        }
    }
    let bad = |problem: &str| BadInput(format!("{}: {problem}", capture.display()));
    let ranges = match frames_beside(capture) {
        Some(list) => listed_ranges(&list)?,
        None => {
            let packets = packets_per_revolution(&datagrams)
                .ok_or_else(|| bad("fewer than two packets that follow each other; a revolution has 76"))?;
            (0..datagrams.len() / packets).map(|frame| (frame * packets, packets)).collect()
        }
    };
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut sweeps = Vec::new();
    for (first, packets) in ranges {
        let some =
            datagrams.get(first..first + packets).ok_or_else(|| {
                bad(&format!(
                    "{} packets, and the list of frames beside it asks for packets {first} to {}; the capture is cut off, or the list is of another one",
                    datagrams.len(),
                    first + packets
                ))
            })?;
        sweeps.push(sweep_of(&mut decoder, some));
    }
    if sweeps.is_empty() {
        return Err(bad(&format!("{} packets are no whole revolution", datagrams.len())).into());
    }
    Ok(sweeps)
}

/// Where the sensor of such a capture stands: still, upright, at the height that the first floor tells.
#[must_use]
pub fn standing_context(sweeps: &[Box<Sweep>], angles: &RingAngles) -> SweepContext {
    let height_m = sweeps.iter().find_map(|sweep| FloorHeight::estimate_m(sweep, angles));
    SweepContext {
        sensor_in_base: Transform3 {
            translation: Point3::new(0.0, 0.0, height_m.unwrap_or(ASSUMED_HEIGHT_M)),
            ..Transform3::IDENTITY
        },
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    }
}

/// `a/b.pcap.gz` → `a/b.frames.csv`, if it exists.
fn frames_beside(capture: &Path) -> Option<PathBuf> {
    let name = capture.file_name()?.to_str()?;
    let stem = name.trim_end_matches(".gz").trim_end_matches(".pcap").trim_end_matches(".pcapng");
    let list = capture.with_file_name(format!("{stem}.frames.csv"));
    list.exists().then_some(list)
}

/// First packet and number of packets of each frame, from the columns of these names.
fn listed_ranges(list: &Path) -> anyhow::Result<Vec<(usize, usize)>> {
    let text = read_text(list)?;
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", list.display()));
    let mut lines = text.lines().enumerate();
    let (_, names) = lines.next().ok_or_else(|| bad(1, "the list is empty"))?;
    let column = |wanted: &str| names.split(',').position(|name| name.trim() == wanted);
    let (first, packets) = column("first_packet")
        .zip(column("packets"))
        .ok_or_else(|| bad(1, "expected columns `packets` and `first_packet`"))?;
    lines
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(index, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let cell = |column: usize| cells.get(column).and_then(|cell| cell.trim().parse::<usize>().ok());
            cell(first)
                .zip(cell(packets))
                .ok_or_else(|| bad(index + 1, "packets and first packet are whole numbers").into())
        })
        .collect()
}

/// From the turn of the head between two packets in a row.
fn packets_per_revolution(datagrams: &[Datagram]) -> Option<usize> {
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut azimuths = datagrams.iter().filter_map(|datagram| {
        let stamp = Stamp::from_micros(datagram.captured_us);
        let (packet, _) = decoder.decode(&datagram.payload, stamp).ok()?;
        packet.columns.first().map(|column| u32::from(column.azimuth_cdeg))
    });
    let (first, second) = (azimuths.next()?, azimuths.next()?);
    let turned_cdeg = (second + 36_000 - first) % 36_000;
    (turned_cdeg > 0).then(|| 36_000_u32.div_ceil(turned_cdeg) as usize)
}

/// The packets of one frame as a sweep, cut before the first of them.
fn sweep_of(decoder: &mut Decoder, datagrams: &[Datagram]) -> Box<Sweep> {
    let mut building = Box::new(Sweep::EMPTY);
    let mut complete: Option<Box<Sweep>> = None;
    let mut builder: Option<SweepBuilder> = None;
    for datagram in datagrams {
        let arrival = Stamp::from_micros(datagram.captured_us);
        let Ok((packet, _)) = decoder.decode(&datagram.payload, arrival) else { continue };
        let Some(first) = packet.columns.first() else { continue };
        let builder = builder.get_or_insert_with(|| SweepBuilder::new(first.azimuth_cdeg));
        builder.add(&packet, 0, &mut building, |sweep| complete = Some(Box::new(sweep.clone())));
    }
    complete.unwrap_or(building)
}
