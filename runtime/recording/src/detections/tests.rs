//! Messages that other libraries serialised: `rosbags` 0.11 (CDR) and Foxglove's own classes for Protocol Buffers.

use std::sync::Arc;

use floorguard_types::time::Stamp;

use super::{DetectedBox, Detections, is_detections, read_detections};
use crate::Recorded;

/// Octets as hexadecimal digits; `*N.` stands for N zeros.
const ARRAY: &str = "000100000c000000b0a09a140700000063616d6572610000020000000c000000b0a09a140700000063616d657261000002000000040000\
    00646f67009a9999999999c93f*54.f03f*288.07000000706572736f6e*12.e83f*54.f03f*293.087440*6.6e40*13.405440*6.6940\
    03000000613100000c000000b0a09a14020000006300000001000000060000006368616972000000cdccccccccccec3f*54.f03f*294.5\
    940*5.c07240*14.4440*6.4e4001*4.";
const ANNOTATIONS: &str = "00010000010000000c000000b0a09a14*10.f03f*7.40*6.0840*6.f03f*6.f03f*22.f03f*6.f03f*22.f03f020000000c000000b0a09\
    a140200000004*12.807140*5.806140*5.907640*5.806140*5.907640*5.407540*5.807140*5.407540*6.f03f*22.f03f01*13.f03\
    f*22.f03f*6.f03f*22.f03f*7.400c000000b0a09a140300000002*25.1440*6.2240*6.f03f*22.f03f*14.f03f*22.f03f*7.400100\
    00000c000000b0a09a14*9.807140*5.e060400c000000706572736f6e20302e3735*7.2840*6.f03f*22.f03f*6.f03f*22.f03f";
const PROTOBUF: &str = "0a14120909*6.f03f19*6.084012700a08080c10b0c1eaa40110021a1209*5.80714011*5.8061401a1209*5.90764011*5.8061401a12\
    09*5.90764011*5.4075401a1209*5.80714011*5.407540220909*6.f03f39*7.401a2a121209*5.80714011*5.e060401a0b70657273\
    6f6e20302e373521*6.2840";

fn octets(text: &str) -> Vec<u8> {
    let mut octets = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        if let Some(run) = rest.strip_prefix('*') {
            let (count, after) = run.split_once('.').unwrap();
            octets.resize(octets.len() + count.parse::<usize>().unwrap(), 0);
            rest = after;
        } else {
            octets.push(u8::from_str_radix(&rest[..2], 16).unwrap());
            rest = &rest[2..];
        }
    }
    octets
}

fn message(schema: &str, encoding: &str, data: Vec<u8>) -> Recorded {
    let stamp = Stamp::from_micros(99);
    Recorded {
        topic: Arc::from("/people"),
        schema: Arc::from(schema),
        encoding: Arc::from(encoding),
        at: stamp,
        published: stamp,
        data,
    }
}

fn person() -> DetectedBox {
    DetectedBox { class: "person".to_owned(), score: 0.75, edges_px: [280.0, 140.0, 361.0, 340.0] }
}

const TAKEN: Stamp = Stamp::from_micros(12_345_678);

#[test]
fn detection_array_of_ros_is_read() {
    let data = octets(ARRAY);
    assert_eq!(data.len(), 1_257);
    let schema = "vision_msgs/msg/Detection2DArray";
    assert!(is_detections(schema));
    let chair = DetectedBox { class: "chair".to_owned(), score: 0.9, edges_px: [80.0, 270.0, 120.0, 330.0] };
    let found = read_detections(&message(schema, "cdr", data.clone()));
    assert_eq!(found, Some(Detections { stamp: TAKEN, boxes: vec![person(), chair] }));
    for cut in 0..data.len() {
        assert_eq!(read_detections(&message(schema, "cdr", data[..cut].to_vec())), None, "cut at {cut}");
    }
    assert_eq!(read_detections(&message(schema, "ros1", data)), None);
}

#[test]
fn annotations_are_read_in_three_encodings() {
    let expected = Some(Detections { stamp: TAKEN, boxes: vec![person()] });
    let cdr = message("foxglove_msgs/msg/ImageAnnotations", "cdr", octets(ANNOTATIONS));
    assert_eq!(read_detections(&cdr), expected);
    let protobuf = message("foxglove.ImageAnnotations", "protobuf", octets(PROTOBUF));
    assert_eq!(read_detections(&protobuf), expected);
    let text = r#"{"points":[{"timestamp":{"sec":12,"nsec":345678000},"type":2,"points":[{"x":280,"y":140},
        {"x":361,"y":140},{"x":361,"y":340},{"x":280,"y":340}]},{"type":3,"points":[{"x":0,"y":0},{"x":5,"y":9}]}],
        "texts":[{"position":{"x":280,"y":135},"text":"person: 75%"}]}"#;
    let json = message("foxglove.ImageAnnotations", "json", text.as_bytes().to_vec());
    assert_eq!(read_detections(&json), expected);
    let cut = message("foxglove.ImageAnnotations", "protobuf", octets(PROTOBUF)[..60].to_vec());
    assert_eq!(read_detections(&cut), None);
}
