//! Pictures of ROS 2: `sensor_msgs/msg/CompressedImage` and `sensor_msgs/msg/Image`.

use floorguard_types::time::Stamp;

use super::Recorded;
use super::cdr::Decoder;

/// A picture in a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureMessage<'a> {
    /// When it was taken.
    pub stamp: Stamp,
    /// Its pixels.
    pub pixels: Pixels<'a>,
}

/// How the pixels stand in a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pixels<'a> {
    /// A whole JPEG or PNG file.
    File(&'a [u8]),
    /// Row by row.
    Rows {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
        /// `rgb8`, `bgr8`, `mono8` and others.
        encoding: String,
        /// Octets from row to row.
        step: usize,
        /// The octets.
        octets: &'a [u8],
    },
}

/// Whether a message of this type is a picture.
#[must_use]
pub fn is_picture(schema: &str) -> bool {
    matches!(schema.rsplit('/').next(), Some("CompressedImage" | "Image"))
}

/// The picture of a message; `None` if it is damaged or of another type.
#[must_use]
pub fn read_picture(message: &Recorded) -> Option<PictureMessage<'_>> {
    if &*message.encoding != "cdr" {
        return None;
    }
    let mut decoder = Decoder::new(&message.data)?;
    let (seconds, nanoseconds) = (decoder.i32()?, decoder.u32()?);
    let micros = u64::try_from(seconds).ok()? * 1_000_000 + u64::from(nanoseconds / 1_000);
    let stamp = Stamp::from_micros(micros);
    let _frame = decoder.text()?;
    let pixels = match message.schema.rsplit('/').next()? {
        "CompressedImage" => {
            let _format = decoder.text()?;
            Pixels::File(decoder.octets()?)
        }
        "Image" => {
            let (height, width, encoding) = (decoder.u32()?, decoder.u32()?, decoder.text()?);
            let _is_big_endian = decoder.u8()?;
            let step = decoder.length()?;
            Pixels::Rows { width, height, encoding, step, octets: decoder.octets()? }
        }
        _ => return None,
    };
    Some(PictureMessage { stamp, pixels })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::cdr::Encoder;

    #[test]
    fn both_kinds_are_read_and_cuts_are_refused() {
        let message = |schema: &str, data: Vec<u8>| Recorded {
            topic: Arc::from("/camera"),
            schema: Arc::from(schema),
            encoding: Arc::from("cdr"),
            at: Stamp::ZERO,
            published: Stamp::ZERO,
            data,
        };
        let mut encoder = Encoder::new();
        encoder.i32(3).u32(250_000_000).text("camera").text("jpeg").octets(&[1, 2, 3]);
        let file = message("sensor_msgs/msg/CompressedImage", encoder.finish());
        let found = read_picture(&file).unwrap();
        assert_eq!((found.stamp.as_micros(), found.pixels), (3_250_000, Pixels::File(&[1, 2, 3])));
        let mut encoder = Encoder::new();
        encoder
            .i32(3)
            .u32(0)
            .text("camera")
            .u32(1)
            .u32(2)
            .text("bgr8")
            .u8(0)
            .u32(6)
            .octets(&[1, 2, 3, 4, 5, 6]);
        let rows = message("sensor_msgs/msg/Image", encoder.finish());
        let expected = Pixels::Rows {
            width: 2,
            height: 1,
            encoding: "bgr8".to_owned(),
            step: 6,
            octets: &[1, 2, 3, 4, 5, 6],
        };
        assert_eq!(read_picture(&rows).unwrap().pixels, expected);
        for cut in 0..rows.data.len() {
            assert_eq!(read_picture(&message("sensor_msgs/msg/Image", rows.data[..cut].to_vec())), None);
        }
    }
}
