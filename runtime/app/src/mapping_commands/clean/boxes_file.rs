//! Boxes of a detector: JSON, CSV, or messages of a recording.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{beginning, unpacked};
use floorguard_mapping::people_removal::PersonBox;
use floorguard_mapping_host::clean::ImageBoxes;
use floorguard_recording::Recording;
use floorguard_recording::detections::{DetectedBox, is_detections, read_detections};
use floorguard_types::sensing::Pixel;
use serde::Deserialize;

use crate::files::text;
use crate::recordings::MCAP_MAGIC;

/// What a person is called: usual names, the number in detectors of COCO's 80 classes, or nothing.
const PERSON: [&str; 5] = ["person", "pedestrian", "people", "0", ""];

/// A file of boxes, JSON.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxesFile {
    width: Option<u32>,
    height: Option<u32>,
    images: Vec<ImageRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageRow {
    time_s: f64,
    width: Option<u32>,
    height: Option<u32>,
    boxes: Vec<BoxRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxRow {
    #[serde(default)]
    class: String,
    #[serde(default = "one")]
    score: f64,
    /// Left, upper, right, lower edge, pixels.
    r#box: [f64; 4],
}

const fn one() -> f64 {
    1.0
}

/// Reads the people of a file, in the order of the file.
///
/// # Errors
/// It cannot be read or is no such file, or a recording holds no boxes.
pub fn read_boxes(path: &Path) -> anyhow::Result<Vec<ImageBoxes>> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let start = beginning(path, MCAP_MAGIC.len() as u64).map_err(|error| bad(&error))?;
    if start.starts_with(MCAP_MAGIC) {
        return of_recording(path);
    }
    let text = text(path)?;
    if text.trim_start().starts_with('{') {
        let file: BoxesFile = serde_json::from_str(&text).map_err(|error| bad(&error))?;
        return Ok(of_json(file));
    }
    Ok(of_csv(&text).map_err(|what| bad(&what))?)
}

fn is_person(class: &str) -> bool {
    PERSON.contains(&class.to_ascii_lowercase().as_str())
}

fn person(score: f64, [left, top, right, bottom]: [f64; 4]) -> PersonBox {
    let pixel = |column: f64, row: f64| Pixel { column: column as f32, row: row as f32 };
    PersonBox { confidence: score as f32, upper_left: pixel(left, top), lower_right: pixel(right, bottom) }
}

fn of_json(file: BoxesFile) -> Vec<ImageBoxes> {
    let image = |image: ImageRow| {
        let size = image.width.or(file.width).zip(image.height.or(file.height));
        let people = image.boxes.into_iter().filter(|each| is_person(&each.class));
        ImageBoxes {
            stamp_s: image.time_s,
            size: size.map(|(width, height)| [width, height]),
            boxes: people.map(|each| person(each.score, each.r#box)).collect(),
        }
    };
    file.images.into_iter().map(image).collect()
}

/// `time_s,left,top,right,bottom[,score[,class]]` a line; lines of the same time are one picture.
fn of_csv(text: &str) -> Result<Vec<ImageBoxes>, String> {
    let mut images: Vec<ImageBoxes> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split([',', ';', '\t']).map(str::trim).collect();
        let is_names = index == 0 && words[0].parse::<f64>().is_err();
        if is_names || words == [""] || line.starts_with('#') {
            continue;
        }
        let numbers: Vec<f64> = words.iter().map_while(|word| word.parse().ok()).collect();
        let [time_s, left, top, right, bottom, ..] = numbers[..] else {
            let what = "time_s,left,top,right,bottom and, if known, score and class are expected";
            return Err(format!("line {}: {what}", index + 1));
        };
        if images.last().is_none_or(|last| last.stamp_s != time_s) {
            images.push(ImageBoxes { stamp_s: time_s, ..ImageBoxes::default() });
        }
        let score = numbers.get(5).copied().unwrap_or(1.0);
        if let Some(last) = images.last_mut().filter(|_| is_person(words.get(6).unwrap_or(&""))) {
            last.boxes.push(person(score, [left, top, right, bottom]));
        }
    }
    Ok(images)
}

/// All boxes of the topic with most messages.
fn of_recording(path: &Path) -> anyhow::Result<Vec<ImageBoxes>> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let opened = File::open(path).and_then(unpacked).map_err(|error| bad(&error))?;
    let mut topics: BTreeMap<String, Vec<ImageBoxes>> = BTreeMap::new();
    let mut damaged = 0_u64;
    for message in Recording::new(BufReader::new(opened)) {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                say!("note: {}: {error}", path.display());
                break;
            }
        };
        if !is_detections(&message.schema) {
            continue;
        }
        let Some(found) = read_detections(&message) else {
            damaged += 1;
            continue;
        };
        let is_wanted = |each: &&DetectedBox| is_person(&each.class);
        topics.entry(message.topic.to_string()).or_default().push(ImageBoxes {
            stamp_s: found.stamp.as_micros() as f64 * 1.0e-6,
            size: None,
            boxes: found
                .boxes
                .iter()
                .filter(is_wanted)
                .map(|each| person(each.score, each.edges_px))
                .collect(),
        });
    }
    if damaged > 0 {
        say!("note: {}: {damaged} damaged messages of boxes were left out", path.display());
    }
    let most = topics.into_values().max_by_key(Vec::len);
    Ok(most.ok_or_else(|| bad(&"no vision_msgs/Detection2DArray and no foxglove ImageAnnotations in it"))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> anyhow::Result<Vec<ImageBoxes>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("boxes");
        std::fs::write(&path, text)?;
        read_boxes(&path)
    }

    #[test]
    fn json_and_csv_say_the_same() {
        let json = r#"{"images":[{"time_s":1.5,"boxes":[{"class":"person","score":0.75,"box":[1,2,30,40]},
            {"class":"dog","box":[1,2,3,4]}]},{"time_s":2,"boxes":[{"box":[5,6,7,8]}]}]}"#;
        let csv = "time_s,left,top,right,bottom,score,class\n1.5,1,2,30,40,0.75,person\n1.5,1,2,3,4,1,dog\n2,5,6,7,8\n";
        let (json, csv) = (read(json).unwrap(), read(csv).unwrap());
        assert_eq!(json, csv);
        assert_eq!((json.len(), json[0].boxes.len(), json[0].boxes[0].confidence), (2, 1, 0.75));
    }

    #[test]
    fn other_files_are_refused_with_the_reason() {
        let why = |text: &str| read(text).unwrap_err().to_string();
        assert!(why("1.0,2\n").contains("line 1: time_s,left"));
        assert!(why(r#"{"images":[{"time":1}]}"#).contains("unknown field"));
    }
}
