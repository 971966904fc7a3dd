//! Colour pictures of a folder or of a bag, in the order of their times.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_recording::Recording;
use floorguard_recording::picture_messages::{Pixels, is_picture, read_picture};
use floorguard_robot::camera::stamp_of_name;
use floorguard_types::time::Stamp;

/// A colour picture.
pub struct TakenPicture {
    /// When it was taken.
    pub stamp: Stamp,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Row by row, three octets a pixel: as many as the size says.
    pub rgb: Vec<u8>,
}

/// Size and pixels.
type Pixmap = ([u32; 2], Vec<u8>);

/// Takes pictures one by one.
pub type Sink<'a> = dyn FnMut(TakenPicture) -> anyhow::Result<()> + 'a;

/// Hands over every picture.
///
/// # Errors
/// It is neither, a picture is damaged, or the sink's own.
pub fn for_each_picture(path: &Path, each: &mut Sink<'_>) -> anyhow::Result<()> {
    if path.is_dir() { of_folder(path, each) } else { of_bag(path, each) }
}

fn of_folder(folder: &Path, each: &mut Sink<'_>) -> anyhow::Result<()> {
    let bad = |path: &Path, what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let entries = std::fs::read_dir(folder).map_err(|error| bad(folder, &error))?;
    let mut files: Vec<(u64, PathBuf)> = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| bad(folder, &error))?.path();
        let ending =
            path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        if !matches!(ending.as_str(), "png" | "jpg" | "jpeg") {
            continue;
        }
        let base = path.file_stem().and_then(|base| base.to_str()).unwrap_or_default();
        let stamp_us = stamp_of_name(base).ok_or_else(|| {
            bad(&path, &"the name ends in no time (seconds with a point, or 12 to 19 digits)")
        })?;
        files.push((stamp_us, path));
    }
    if files.is_empty() {
        return Err(bad(folder, &"no .png, .jpg or .jpeg in it").into());
    }
    files.sort();
    for (stamp_us, path) in files {
        let bytes = std::fs::read(&path).map_err(|error| bad(&path, &error))?;
        let (size, rgb) = picture(&bytes).map_err(|what| bad(&path, &what))?;
        each(TakenPicture { stamp: Stamp::from_micros(stamp_us), size, rgb })?;
    }
    Ok(())
}

fn of_bag(path: &Path, each: &mut Sink<'_>) -> anyhow::Result<()> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let opened = File::open(path).and_then(unpacked).map_err(|error| bad(&error))?;
    let mut topic = None;
    for message in Recording::new(BufReader::new(opened)) {
        let message = message.map_err(|error| bad(&error))?;
        if !is_picture(&message.schema)
            || *topic.get_or_insert_with(|| message.topic.clone()) != message.topic
        {
            continue;
        }
        let Some(found) = read_picture(&message) else { continue };
        let picture = match found.pixels {
            Pixels::File(bytes) => picture(bytes),
            Pixels::Rows { width, height, encoding, step, octets } => {
                rows([width, height], &encoding, (step, octets))
            }
        };
        let (size, rgb) = picture.map_err(|what| bad(&format!("{}: {what}", message.topic)))?;
        each(TakenPicture { stamp: found.stamp, size, rgb })?;
    }
    Ok(topic.map(|_| ()).ok_or_else(|| bad(&"no CompressedImage and no Image in it"))?)
}

/// A JPEG or PNG file.
fn picture(bytes: &[u8]) -> Result<Pixmap, String> {
    let image = image::load_from_memory(bytes).map_err(|error| error.to_string())?.into_rgb8();
    Ok(([image.width(), image.height()], image.into_raw()))
}

/// Rows of a message.
fn rows(size: [u32; 2], encoding: &str, (step, octets): (usize, &[u8])) -> Result<Pixmap, String> {
    let (channels, order) = match encoding {
        "rgb8" => (3, [0, 1, 2]),
        "bgr8" => (3, [2, 1, 0]),
        "rgba8" => (4, [0, 1, 2]),
        "bgra8" => (4, [2, 1, 0]),
        "mono8" | "8UC1" => (1, [0, 0, 0]),
        other => return Err(format!("pictures as {other:?}; rgb8, bgr8, rgba8, bgra8 and mono8 are read")),
    };
    let [width, height] = size.map(|side| side as usize);
    let is_whole = step >= width.saturating_mul(channels) && octets.len() >= step.saturating_mul(height);
    if !is_whole || step == 0 || width == 0 || height == 0 {
        return Err("the sizes of the picture contradict each other".to_owned());
    }
    let mut found = Vec::with_capacity(3 * width * height);
    for row in octets.chunks_exact(step).take(height) {
        for pixel in row.chunks_exact(channels).take(width) {
            found.extend(order.map(|channel| pixel[channel]));
        }
    }
    Ok((size, found))
}
