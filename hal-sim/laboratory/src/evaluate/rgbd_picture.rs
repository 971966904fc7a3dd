//! A depth picture with the people that were found in it.

use floorguard_perception::rgbd_people::{LegCandidate, RgbdDetection, RgbdKind};
use floorguard_types::sensing::DepthImage;
use image::{Rgb, RgbImage};

use floorguard_robot::picture_files::ColourFile;

/// Depth in grey, or the colours; upper bodies in a yellow frame, both in a green one, pairs of legs in a blue one, single
/// legs in grey.
pub(super) fn picture(
    image: &DepthImage<'_>,
    colour: Option<&ColourFile>,
    people: &[RgbdDetection],
    legs: &[LegCandidate],
) -> RgbImage {
    let mut picture = RgbImage::new(image.width() as u32, image.height() as u32);
    for (index, (depth, pixel)) in image.depth_mm().iter().zip(picture.pixels_mut()).enumerate() {
        let grey = if *depth == 0 { 0 } else { 235 - (u32::from(*depth).min(7_000) / 35) as u8 };
        *pixel = colour
            .and_then(|colour| colour.rgb.get(3 * index..3 * index + 3))
            .map_or(Rgb([grey; 3]), |rgb| Rgb([rgb[0], rgb[1], rgb[2]]));
    }
    for leg in legs {
        frame(&mut picture, (leg.first_px, leg.last_px), Rgb([170, 170, 190]));
    }
    for person in people {
        let colour = match person.kind {
            RgbdKind::UpperBody => Rgb([255, 210, 40]),
            RgbdKind::Legs => Rgb([60, 150, 255]),
            RgbdKind::UpperBodyAndLegs => Rgb([60, 220, 90]),
        };
        frame(&mut picture, (person.first_px, person.last_px), colour);
    }
    picture
}

/// A frame, as far as it lies in the picture.
fn frame(picture: &mut RgbImage, ([left, top], [right, bottom]): ([u16; 2], [u16; 2]), colour: Rgb<u8>) {
    let (width, height) = picture.dimensions();
    let [left, top, right, bottom] = [left, top, right, bottom].map(u32::from);
    for column in left..=right.min(width.saturating_sub(1)) {
        for row in [top, bottom].into_iter().filter(|row| *row < height) {
            picture.put_pixel(column, row, colour);
        }
    }
    for row in top..=bottom.min(height.saturating_sub(1)) {
        for column in [left, right].into_iter().filter(|column| *column < width) {
            picture.put_pixel(column, row, colour);
        }
    }
}
