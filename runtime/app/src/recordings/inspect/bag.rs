//! Recordings and bags.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use floorguard_host::packing::unpacked;
use floorguard_recording::replay::is_replayable;
use floorguard_recording::{Recorded, Recording, decode};

use super::page::{Page, Stream};
use super::timeline::Timeline;
use floorguard_host::outcome::BadInput;

#[derive(Default)]
struct Topic {
    schema: String,
    encoding: String,
    timeline: Timeline,
    frame: Option<String>,
    fields: Vec<String>,
    empty: u64,
    damaged: u64,
}

/// What a message says of itself.
#[derive(Default)]
struct SelfDescription {
    stamp_us: Option<u64>,
    frame: Option<String>,
    fields: Vec<String>,
    is_empty: bool,
}

/// A recording, to its end or its cut.
///
/// # Errors
/// It cannot be opened.
pub fn page(file: &Path) -> anyhow::Result<Page> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", file.display()));
    let mut recording = Recording::new(BufReader::new(File::open(file).and_then(unpacked).map_err(bad)?));
    let mut topics = BTreeMap::<String, Topic>::new();
    let mut page = Page::new("a recording (MCAP)");
    for message in recording.by_ref() {
        match message {
            Ok(message) => enter(topics.entry(message.topic.to_string()).or_default(), &message),
            Err(error) => page.faults.push(error.to_string()),
        }
    }
    let kinds: Vec<String> = topics.values().map(|topic| kind(&topic.schema).to_owned()).collect();
    let has = |wanted: &str| kinds.iter().any(|kind| kind == wanted);
    let is_ours = is_replayable(&recording);
    if is_ours {
        "a recording of floorguard (MCAP)".clone_into(&mut page.kind);
        page.commands.push("floorguard replay: through the same tasks, with the same digest".to_owned());
        page.commands.push("floorguard report: one page with map, stops, people".to_owned());
    } else {
        let found = [
            ("PointCloud2", "floorguard replay: people in its point clouds"),
            ("LaserScan", "floorguard replay: legs and people in its scans"),
        ];
        page.commands.extend(found.iter().filter(|(kind, _)| has(kind)).map(|(_, what)| (*what).to_owned()));
        if !page.commands.is_empty() && !has("TFMessage") {
            page.faults.push(
                "no frames (tf_static): the sensor is taken to stand upright at the robot's origin"
                    .to_owned(),
            );
        }
        if !page.commands.is_empty() && !has("Odometry") {
            page.faults.push("no odometry: people are in the frame of the sensor".to_owned());
        }
    }
    if has("LaserScan") {
        page.commands.push("floorguard map: a map of the building by its scans".to_owned());
    }
    page.streams = topics.into_iter().map(|(name, topic)| stream(name, topic)).collect();
    Ok(page)
}

fn kind(schema: &str) -> &str {
    schema.rsplit('/').next().unwrap_or(schema)
}

fn enter(topic: &mut Topic, message: &Recorded) {
    topic.schema = message.schema.to_string();
    topic.encoding = message.encoding.to_string();
    let description = if topic.encoding == "cdr" { description(&topic.schema, &message.data) } else { None };
    topic.damaged += u64::from(description.is_none() && topic.encoding == "cdr");
    let description = description.unwrap_or_default();
    topic.timeline.add(description.stamp_us.unwrap_or_else(|| message.at.as_micros()));
    topic.empty += u64::from(description.is_empty);
    topic.frame = topic.frame.take().or(description.frame);
    if topic.fields.is_empty() {
        topic.fields = description.fields;
    }
}

/// `None` for a message of a known kind that cannot be read.
fn description(schema: &str, data: &[u8]) -> Option<SelfDescription> {
    let of = |header: decode::Header, fields, is_empty| SelfDescription {
        stamp_us: Some(header.stamp.as_micros()),
        frame: Some(header.frame),
        fields,
        is_empty,
    };
    Some(match kind(schema) {
        "PointCloud2" => {
            let cloud = decode::cloud(data)?;
            let points = cloud.width.saturating_mul(cloud.height);
            let mut fields: Vec<String> = cloud.fields.iter().map(|field| field.name.clone()).collect();
            fields.push(format!("{points} points in the first"));
            of(cloud.header, fields, points == 0)
        }
        "LaserScan" => {
            let scan = decode::laser_scan(data)?;
            let beams = scan.ranges_m.len();
            let degrees = (scan.step_rad.to_degrees() * beams.saturating_sub(1) as f32).abs();
            let fields = vec![format!("{beams} beams over {degrees:.0}°")];
            of(scan.header, fields, beams == 0)
        }
        "Odometry" => of(decode::odometry(data)?.header, Vec::new(), false),
        "Imu" => of(decode::imu(data)?.header, Vec::new(), false),
        "TFMessage" => {
            let frames = decode::frames(data)?;
            let named =
                frames.iter().map(|frame| format!("{} in {}", frame.child, frame.header.frame)).collect();
            SelfDescription { fields: named, is_empty: frames.is_empty(), ..SelfDescription::default() }
        }
        _ => SelfDescription::default(),
    })
}

fn stream(name: String, topic: Topic) -> Stream {
    let mut stream = Stream::new(name, topic.schema, &topic.timeline);
    (stream.frame, stream.fields) = (topic.frame, topic.fields);
    if topic.empty > 0 {
        stream.faults.push(format!("{} are empty: the sensor sent no values", topic.empty));
    }
    if topic.damaged > 0 {
        stream.faults.push(format!("{} cannot be read", topic.damaged));
    }
    stream
}
