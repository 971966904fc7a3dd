//! A growing SVG document and the mapping from metres to its pixels.

use std::fmt::Write as _;

use floorguard_types::geometry::Point2;

/// Text of an SVG document; elements are painted in the order in which they are added.
pub(super) struct Canvas {
    text: String,
}

/// How a line or an area is painted.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub fill: &'static str,
    pub stroke: &'static str,
    pub width_px: f32,
    pub opacity: f32,
}

/// Where text goes and how it looks.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    pub at_px: (f32, f32),
    pub size_px: f32,
    pub colour: &'static str,
    /// `start`, `middle` or `end`.
    pub anchor: &'static str,
    pub is_bold: bool,
}

impl Canvas {
    pub(super) fn new(width_px: f32, height_px: f32, description: &str) -> Self {
        let mut canvas = Self { text: String::new() };
        canvas.add(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_px:.0}\" height=\"{height_px:.0}\" \
             viewBox=\"0 0 {width_px:.0} {height_px:.0}\" role=\"img\" \
             font-family=\"'Inter','Segoe UI','Helvetica Neue','DejaVu Sans',Arial,sans-serif\">\
             \n<title>{}</title>",
            escaped(description)
        ));
        canvas
    }

    fn add(&mut self, arguments: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(arguments);
        self.text.push('\n');
    }

    pub(super) fn rectangle(&mut self, (x, y): (f32, f32), (width, height): (f32, f32), ink: Ink) {
        let style = style(ink);
        self.add(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"2\" {style}/>"
        ));
    }

    pub(super) fn circle(&mut self, (x, y): (f32, f32), radius_px: f32, ink: Ink) {
        let style = style(ink);
        self.add(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius_px:.1}\" {style}/>"));
    }

    /// A line through the points, or the outline that they enclose.
    pub(super) fn path(&mut self, points: &[(f32, f32)], is_closed: bool, ink: Ink) {
        let Some(((x, y), rest)) = points.split_first() else { return };
        let mut data = format!("M{x:.1} {y:.1}");
        for (x, y) in rest {
            let _ = write!(data, "L{x:.1} {y:.1}");
        }
        if is_closed {
            data.push('Z');
        }
        let style = style(ink);
        self.add(format_args!(
            "<path d=\"{data}\" {style} stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        ));
    }

    pub(super) fn text(&mut self, text: &str, lettering: Lettering) {
        let Lettering { at_px: (x, y), size_px, colour, anchor, is_bold } = lettering;
        let weight = if is_bold { 600 } else { 400 };
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size_px:.0}\" font-weight=\"{weight}\" \
             fill=\"{colour}\" text-anchor=\"{anchor}\">{}</text>",
            escaped(text)
        ));
    }

    /// Text whose middle is at its place also from top to bottom, whatever size a page gives it.
    pub(super) fn centred_text(&mut self, text: &str, lettering: Lettering) {
        self.add(format_args!("<g dominant-baseline=\"central\">"));
        self.text(text, lettering);
        self.close_group();
    }

    /// What follows belongs to a class, so that a page can change its style.
    pub(super) fn open_group(&mut self, class: &'static str) {
        self.add(format_args!("<g class=\"{class}\">"));
    }

    pub(super) fn close_group(&mut self) {
        self.add(format_args!("</g>"));
    }

    pub(super) fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

fn style(ink: Ink) -> String {
    let Ink { fill, stroke, width_px, opacity } = ink;
    format!("fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width_px:.1}\" opacity=\"{opacity:.2}\"")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Maps the part of the floor that is shown to pixels. The map's y axis points up, the picture's down.
#[derive(Clone, Copy)]
pub(super) struct Mapping {
    pub lowest: Point2,
    pub highest: Point2,
    pub origin_px: (f32, f32),
    pub px_per_m: f32,
}

impl Mapping {
    /// Fits the points with a margin into an area; without a finite point the metre around the origin is shown.
    pub(super) fn fit<'a>(
        points: impl Iterator<Item = &'a Point2>,
        origin_px: (f32, f32),
        area_px: (f32, f32),
    ) -> Self {
        const MARGIN_M: f32 = 0.5;
        let mut bounds: Option<(Point2, Point2)> = None;
        for point in points.filter(|point| point.x_m.is_finite() && point.y_m.is_finite()) {
            let (low, high) = bounds.unwrap_or((*point, *point));
            bounds = Some((
                Point2::new(low.x_m.min(point.x_m), low.y_m.min(point.y_m)),
                Point2::new(high.x_m.max(point.x_m), high.y_m.max(point.y_m)),
            ));
        }
        let (low, high) = bounds.unwrap_or_default();
        let lowest = Point2::new(low.x_m - MARGIN_M, low.y_m - MARGIN_M);
        let highest = Point2::new(high.x_m + MARGIN_M, high.y_m + MARGIN_M);
        // The margins keep both extents above zero.
        let px_per_m = (area_px.0 / (highest.x_m - lowest.x_m)).min(area_px.1 / (highest.y_m - lowest.y_m));
        Self { lowest, highest, origin_px, px_per_m }
    }

    /// Size of the shown part, pixels.
    pub(super) fn size_px(&self) -> (f32, f32) {
        (
            (self.highest.x_m - self.lowest.x_m) * self.px_per_m,
            (self.highest.y_m - self.lowest.y_m) * self.px_per_m,
        )
    }

    pub(super) fn px(&self, point: Point2) -> (f32, f32) {
        (
            self.origin_px.0 + (point.x_m - self.lowest.x_m) * self.px_per_m,
            self.origin_px.1 + (self.highest.y_m - point.y_m) * self.px_per_m,
        )
    }

    /// A path in pixels, without indistinguishable points.
    pub(super) fn path_px(&self, points: impl Iterator<Item = Point2>) -> Vec<(f32, f32)> {
        const DISTINCT_PX: f32 = 0.7;
        let mut path: Vec<(f32, f32)> = Vec::new();
        let mut skipped = None;
        for point in points.filter(|point| point.x_m.is_finite() && point.y_m.is_finite()) {
            let (x, y) = self.px(point);
            let is_distinct =
                path.last().is_none_or(|(last_x, last_y)| (x - last_x).hypot(y - last_y) > DISTINCT_PX);
            skipped = (!is_distinct).then_some((x, y));
            if is_distinct {
                path.push((x, y));
            }
        }
        path.extend(skipped);
        path
    }
}
