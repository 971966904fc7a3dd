//! Bytes of a camera's frame as pixels. A frame of another length than its size is cut off, and no picture.

use floorguard_types::sensing::ImageSize;
use image::ImageFormat;

use crate::picture_files::is_cut_jpeg;

/// A frame that is no picture of the size that was agreed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WrongFrame {
    /// Fewer bytes than the size needs.
    #[error("a frame of {bytes} bytes, {needed} are needed: it was cut off")]
    Short {
        /// Bytes that came.
        bytes: usize,
        /// Bytes of a whole frame.
        needed: usize,
    },
    /// A compressed picture that cannot be read.
    #[error("no picture: {0}")]
    Unreadable(String),
    /// A compressed picture of another size.
    #[error("a picture of {} × {} pixels, not {} × {}", found.width, found.height, wanted.width, wanted.height)]
    OtherSize {
        /// Of the picture that came.
        found: ImageSize,
        /// That was agreed.
        wanted: ImageSize,
    },
    /// What is wrong with a recorded picture.
    #[error("{0}: {1}")]
    InFile(String, Box<Self>),
}

/// How a colour camera packs its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourFormat {
    /// Red, green, blue: three bytes a pixel (`RGB3`).
    Rgb,
    /// Two pixels in four bytes: light, blue, light, red (`YUYV`).
    Yuyv,
    /// A JPEG picture (`MJPG`).
    Jpeg,
}

impl ColourFormat {
    /// In the order in which they are asked for, with the kernel's four letters.
    pub const ALL: [(Self, [u8; 4]); 3] =
        [(Self::Rgb, *b"RGB3"), (Self::Yuyv, *b"YUYV"), (Self::Jpeg, *b"MJPG")];
}

/// How the bytes of a frame lie.
#[derive(Clone, Copy)]
struct FrameRows {
    /// Bytes of the pixels of a row.
    row_bytes: usize,
    /// Rows.
    height: usize,
    /// Bytes from a row to the next.
    line_bytes: usize,
}

/// Rows of a frame whose lines may be longer than their pixels.
fn rows(bytes: &[u8], rows: FrameRows) -> Result<impl Iterator<Item = &[u8]>, WrongFrame> {
    let FrameRows { row_bytes, height, line_bytes } = rows;
    let line_bytes = line_bytes.max(row_bytes).max(1);
    let needed = line_bytes * height.saturating_sub(1) + row_bytes;
    if bytes.len() < needed {
        return Err(WrongFrame::Short { bytes: bytes.len(), needed });
    }
    Ok(bytes.chunks(line_bytes).take(height).map(move |line| &line[..row_bytes.min(line.len())]))
}

/// Depths in millimetres of a Z16 frame, of which a line takes `line_bytes`.
///
/// # Errors
/// The frame is cut off.
pub fn depth_of(
    bytes: &[u8],
    ImageSize { width, height }: ImageSize,
    line_bytes: usize,
) -> Result<Vec<u16>, WrongFrame> {
    let rows = rows(bytes, FrameRows { row_bytes: 2 * width, height, line_bytes })?;
    Ok(rows.flat_map(|row| row.as_chunks::<2>().0).map(|pair| u16::from_le_bytes(*pair)).collect())
}

/// Red, green and blue of a frame.
///
/// # Errors
/// The frame is cut off, or cannot be unpacked.
pub fn colour_of(
    format: ColourFormat,
    bytes: &[u8],
    ImageSize { width, height }: ImageSize,
    line_bytes: usize,
) -> Result<Vec<u8>, WrongFrame> {
    match format {
        ColourFormat::Rgb => {
            let rows = rows(bytes, FrameRows { row_bytes: 3 * width, height, line_bytes })?;
            Ok(rows.flatten().copied().collect())
        }
        ColourFormat::Yuyv => {
            let rows = rows(bytes, FrameRows { row_bytes: 2 * width, height, line_bytes })?;
            Ok(rows.flat_map(|row| row.as_chunks::<4>().0).flat_map(rgb_of_pair).collect())
        }
        ColourFormat::Jpeg => {
            if is_cut_jpeg(bytes) {
                return Err(WrongFrame::Unreadable("it is cut off".to_owned()));
            }
            let picture = image::load_from_memory_with_format(bytes, ImageFormat::Jpeg)
                .map_err(|problem| WrongFrame::Unreadable(problem.to_string()))?
                .into_rgb8();
            let found = ImageSize { width: picture.width() as usize, height: picture.height() as usize };
            let wanted = ImageSize { width, height };
            if found == wanted {
                Ok(picture.into_raw())
            } else {
                Err(WrongFrame::OtherSize { found, wanted })
            }
        }
    }
}

/// ITU-R BT.601 with 16..=235 for black to white, in whole numbers: 1.164, 1.596, 0.813, 0.392 and 2.017 times 256.
fn rgb_of_pair([first, blue, second, red]: &[u8; 4]) -> [u8; 6] {
    let (u, v) = (i32::from(*blue) - 128, i32::from(*red) - 128);
    let [[a, b, c], [d, e, f]] = [first, second].map(|light| {
        let y = 298 * (i32::from(*light) - 16);
        [y + 409 * v, y - 208 * v - 100 * u, y + 516 * u]
            .map(|value| ((value + 128) >> 8).clamp(0, 255) as u8)
    });
    [a, b, c, d, e, f]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_BY_TWO: ImageSize = ImageSize { width: 2, height: 2 };

    #[test]
    fn cut_frames_are_refused_padded_lines_accepted() {
        let bytes = [1, 2, 3, 4, 9, 9, 5, 6, 7, 8, 9, 9];
        assert_eq!(depth_of(&bytes, TWO_BY_TWO, 6).unwrap(), [0x0201, 0x0403, 0x0605, 0x0807]);
        assert_eq!(depth_of(&bytes, TWO_BY_TWO, 0).unwrap(), [0x0201, 0x0403, 0x0909, 0x0605]);
        assert_eq!(depth_of(&bytes[..9], TWO_BY_TWO, 6), Err(WrongFrame::Short { bytes: 9, needed: 10 }));
        let rgb = |bytes: &[u8]| colour_of(ColourFormat::Rgb, bytes, TWO_BY_TWO, 6);
        assert_eq!(rgb(&bytes).unwrap(), bytes);
        assert_eq!(rgb(&bytes[..11]), Err(WrongFrame::Short { bytes: 11, needed: 12 }));
        assert!(matches!(
            colour_of(ColourFormat::Jpeg, &bytes, TWO_BY_TWO, 6),
            Err(WrongFrame::Unreadable(_))
        ));
    }

    /// A picture of which the end did not come is none, though a decoder would fill the rest with grey.
    #[test]
    fn a_cut_jpeg_is_refused() {
        let mut bytes = Vec::new();
        let picture = image::RgbImage::from_fn(32, 16, |x, y| image::Rgb([(x * y) as u8; 3]));
        picture.write_to(&mut std::io::Cursor::new(&mut bytes), ImageFormat::Jpeg).unwrap();
        let rgb = |bytes: &[u8]| colour_of(ColourFormat::Jpeg, bytes, ImageSize { width: 32, height: 16 }, 0);
        assert_eq!(rgb(&bytes).unwrap().len(), 3 * 32 * 16);
        assert_eq!(rgb(&bytes[..bytes.len() - 40]), Err(WrongFrame::Unreadable("it is cut off".to_owned())));
    }

    /// Black, white, and red by the standard's own numbers.
    #[test]
    fn light_and_colour_differences_become_colours() {
        let rgb = |pair: [u8; 4]| {
            colour_of(ColourFormat::Yuyv, &pair, ImageSize { width: 2, height: 1 }, 4).unwrap()
        };
        assert_eq!(rgb([16, 128, 235, 128]), [0, 0, 0, 255, 255, 255]);
        let red = rgb([81, 90, 81, 240]);
        assert!(red[0] > 250 && red[1] < 5 && red[2] < 5, "{red:?}");
    }
}
