//! The picked pixels and where the mounting puts their points, as a picture.

use std::fmt::Write as _;

use nalgebra::Vector2;

use super::pairs::PickedPair;
use crate::output::base64;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct ResidualPicture<'a> {
    /// Width and height of the camera's pictures, pixels.
    pub size: [u32; 2],
    /// What was picked.
    pub pairs: &'a [PickedPair],
    /// Picked minus projected, pixels.
    pub residuals_px: &'a [Vector2<f64>],
    /// The camera's picture below it, as a file of PNG or JPEG.
    pub photograph: Option<&'a [u8]>,
}

/// Errors are drawn so much longer.
const LONGER: f64 = 20.0;

/// As SVG, all in one file: circles for picks, crosses for projections, and each error twenty times as long.
#[must_use]
pub fn draw_residuals(picture: &ResidualPicture<'_>) -> String {
    let [width, height] = picture.size;
    let unit = f64::from(width.max(height)) / 400.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\">\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#eef1f4\"/>"
    );
    if let Some(bytes) = picture.photograph {
        let kind = if bytes.starts_with(b"\x89PNG") { "png" } else { "jpeg" };
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<image width=\"{width}\" height=\"{height}\" href=\"data:image/{kind};base64,{}\"/>",
            base64(bytes)
        );
    }
    for (index, (pair, residual)) in picture.pairs.iter().zip(picture.residuals_px).enumerate() {
        let projected = pair.pixel - residual;
        let far = projected + residual * LONGER;
        let (x, y, px, py) = (pair.pixel.x, pair.pixel.y, projected.x, projected.y);
        let (arm, radius) = (1.5 * unit, 2.5 * unit);
        let _ = write!(
            svg,
            "<line x1=\"{px:.1}\" y1=\"{py:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#d62828\" stroke-width=\"{unit:.2}\"/>\
             <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"none\" stroke=\"#1d6fd1\" stroke-width=\"{unit:.2}\"/>\
             <path d=\"M{:.1} {py:.1}h{:.1}M{px:.1} {:.1}v{:.1}\" stroke=\"#0f8a3c\" stroke-width=\"{unit:.2}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.1}\" fill=\"#1c2733\">{}: {:.1} px</text>",
            far.x,
            far.y,
            px - arm,
            2.0 * arm,
            py - arm,
            2.0 * arm,
            x + 2.0 * radius,
            y - radius,
            7.0 * unit,
            index + 1,
            residual.norm()
        );
    }
    svg + "</svg>\n"
}
