//! The floor camera's newest picture for people: small, as a JPEG file.

use floorguard_robot::camera::ColourPicture;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder as _};

/// Columns at most; wider pictures are thinned out.
const WIDTH_MAX: usize = 320;
/// Quality of the file, percent.
const QUALITY: u8 = 70;

/// The file; `None` for a picture whose bytes are not of its size.
pub fn jpeg(picture: &ColourPicture) -> Option<Vec<u8>> {
    let (width, height) = (picture.size.width, picture.size.height);
    if picture.rgb.len() != width * height * 3 || picture.rgb.is_empty() {
        return None;
    }
    let every = width.div_ceil(WIDTH_MAX);
    let (columns, rows) = (width / every, height / every);
    let row = |row: usize| {
        let begin = row * every * width * 3;
        picture.rgb.get(begin..begin + width * 3).unwrap_or_default()
    };
    let pixels = (0..rows).flat_map(|at| row(at).chunks_exact(3).step_by(every).take(columns).flatten());
    let pixels: Vec<u8> = pixels.copied().collect();
    let mut file = Vec::new();
    let size = (u32::try_from(columns).ok()?, u32::try_from(rows).ok()?);
    let encoder = JpegEncoder::new_with_quality(&mut file, QUALITY);
    encoder.write_image(&pixels, size.0, size.1, ExtendedColorType::Rgb8).ok()?;
    Some(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::sensing::ImageSize;

    #[test]
    fn picture_is_small_and_keeps_its_colours() {
        let size = ImageSize { width: 640, height: 480 };
        let rgb: Vec<u8> = (0..480 * 640)
            .flat_map(|at| if at % 640 < 320 { [200, 30, 30] } else { [20, 30, 180] })
            .collect();
        let file = jpeg(&ColourPicture { rgb: rgb.clone(), size }).expect("a file");
        let read = image::load_from_memory(&file).expect("a picture").to_rgb8();
        assert_eq!(read.dimensions(), (320, 240));
        let near = |at: (u32, u32), expected: [u8; 3]| {
            let pixel = read.get_pixel(at.0, at.1).0;
            assert!(pixel.iter().zip(expected).all(|(a, b)| a.abs_diff(b) < 12), "{pixel:?}");
        };
        near((40, 100), [200, 30, 30]);
        near((280, 100), [20, 30, 180]);
        assert!(jpeg(&ColourPicture { rgb: rgb[3..].to_vec(), size }).is_none());
    }
}
