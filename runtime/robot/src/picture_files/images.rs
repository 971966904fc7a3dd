//! Pictures from files as what the stages take: depth in millimetres, colour, masks. Whatever does not fit is refused.

use std::io::Cursor;
use std::path::Path;

use floorguard_types::sensing::ImageSize;
use image::{ColorType, ImageReader};

use floorguard_host::outcome::BadInput;

/// A depth picture: whole millimetres, 0 for no return.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DepthFile {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Depths, row by row.
    pub depth_mm: Vec<u16>,
}

/// A colour picture, three bytes a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColourFile {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue, row by row.
    pub rgb: Vec<u8>,
}

/// A mask: true where it is not black.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskFile {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row.
    pub marked: Vec<bool>,
}

/// True for a JPEG picture whose end is missing: after its last scan no end of the image comes. Decoders fill the rest with
/// grey, which is neither floor nor dirt that anybody saw.
#[must_use]
pub fn is_cut_jpeg(bytes: &[u8]) -> bool {
    const START: [u8; 2] = [0xff, 0xd8];
    const SCAN: [u8; 2] = [0xff, 0xda];
    const END: [u8; 2] = [0xff, 0xd9];
    // Within a scan a byte 0xff is followed by 0, so that neither mark stands there by chance.
    let last = |mark: [u8; 2]| bytes.array_windows().rposition(|pair| *pair == mark);
    bytes.starts_with(&START) && last(END) <= last(SCAN)
}

fn open(path: &Path) -> anyhow::Result<image::DynamicImage> {
    let bad = |problem: String| BadInput(format!("{}: {problem}", path.display()));
    let bytes = std::fs::read(path).map_err(|problem| bad(problem.to_string()))?;
    if is_cut_jpeg(&bytes) {
        return Err(bad("the picture is cut off".to_owned()).into());
    }
    let reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|problem| bad(problem.to_string()))?;
    if reader.format().is_none() {
        return Err(bad("this is no picture in a known format (PNG, JPEG or PNM)".to_owned()).into());
    }
    Ok(reader.decode().map_err(|problem| bad(problem.to_string()))?)
}

/// Makes a folder for pictures.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(folder: &Path) -> anyhow::Result<&Path> {
    std::fs::create_dir_all(folder)
        .map_err(|problem| BadInput(format!("{}: cannot be made: {problem}", folder.display())))?;
    Ok(folder)
}

/// Reads a depth picture: one channel of 16 bits, millimetres (Z16).
///
/// # Errors
/// The file is missing, cut off, or has other pixels.
pub fn read_depth(path: &Path) -> anyhow::Result<DepthFile> {
    let picture = open(path)?;
    if picture.color() != ColorType::L16 {
        return Err(BadInput(format!(
            "{}: depth is one channel of 16 bits in millimetres, but this has {} channels of {} bits",
            path.display(),
            picture.color().channel_count(),
            picture.color().bytes_per_pixel() / picture.color().channel_count() * 8,
        ))
        .into());
    }
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    Ok(DepthFile { width, height, depth_mm: picture.into_luma16().into_raw() })
}

/// Reads a colour picture; a grey one has three equal channels.
///
/// # Errors
/// The file is missing, cut off or no picture.
pub fn read_colour(path: &Path) -> anyhow::Result<ColourFile> {
    let picture = open(path)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    Ok(ColourFile { width, height, rgb: picture.into_rgb8().into_raw() })
}

/// Reads a mask and checks that it belongs to a picture of the given size.
///
/// # Errors
/// The file is missing, cut off or no picture, or it has another size.
pub fn read_mask(path: &Path, size: ImageSize) -> anyhow::Result<MaskFile> {
    let picture = open(path)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if (ImageSize { width, height }) != size {
        return Err(BadInput(format!(
            "{}: {width} × {height} pixels, but the picture it belongs to has {} × {}",
            path.display(),
            size.width,
            size.height
        ))
        .into());
    }
    let marked = picture.into_luma8().into_raw().into_iter().map(|value| value > 0).collect();
    Ok(MaskFile { width, height, marked })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, RgbImage};

    /// However much of a picture is missing, it is refused; a whole one, even with something behind it, is not.
    #[test]
    fn a_cut_jpeg_is_no_picture() {
        let picture =
            RgbImage::from_fn(64, 48, |x, y| image::Rgb([(4 * x) as u8, (5 * y) as u8, (x * y) as u8]));
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).expect("room");
        assert!(!is_cut_jpeg(&bytes));
        for length in (0..bytes.len()).step_by(7) {
            let part = &bytes[..length];
            assert!(
                is_cut_jpeg(part) || image::load_from_memory(part).is_err(),
                "{length} of {}",
                bytes.len()
            );
        }
        bytes.extend([0; 9]);
        assert!(!is_cut_jpeg(&bytes));
    }
}
