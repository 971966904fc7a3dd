//! The moment from above, in the robot's frame: its front is up.

use std::fmt::Write as _;

use floorguard_types::geometry::{Point2, Pose2};

use super::gather::Snapshot;
use crate::surroundings::Holder;
use crate::words::Language;

/// Pixels of an edge.
const PX: f32 = 560.0;
/// Metres around the robot, at least and at most.
const AROUND_M: (f32, f32) = (3.0, 10.0);

struct View {
    around_m: f32,
}

impl View {
    /// Forward is up, left is left.
    fn at(&self, place: Point2) -> (f32, f32) {
        let scale = PX / (2.0 * self.around_m);
        ((self.around_m - place.y_m) * scale, (self.around_m - place.x_m) * scale)
    }

    fn path(&self, places: impl Iterator<Item = Point2>, end: &str) -> String {
        let mut path = String::new();
        for (index, place) in places.enumerate() {
            let (x, y) = self.at(place);
            let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        path + end
    }
}

/// As SVG, with a description for those who do not see it.
pub fn picture(snapshots: &[Snapshot], holder: Option<&Holder>, language: Language) -> String {
    let Some(moment) = snapshots.last() else { return String::new() };
    let around = &moment.around;
    let reach = |points: &[Point2]| points.iter().map(|point| point.norm()).fold(0.0, f32::max);
    let holder_m = holder.map_or(0.0, |it| it.x_m.hypot(it.y_m));
    let wanted_m =
        [reach(&around.protective), reach(&around.warning), holder_m].into_iter().fold(0.0, f32::max);
    let view = View { around_m: (wanted_m + 0.8).clamp(AROUND_M.0, AROUND_M.1) };
    let nothing = || language.say("nothing on the map").to_owned();
    let holder_words = holder.map_or_else(nothing, |holder| holder.words_in(language));
    let label = language.fill("Top view at the moment: held by {}", &[&holder_words]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {PX} {PX}\" role=\"img\" \
         aria-label=\"{label}\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\" stroke=\"#d8dee5\"/>"
    );
    grid(&mut svg, &view);
    for (field, fill, edge) in
        [(&around.warning, "#f4d58d", "#8a6100"), (&around.protective, "#f1a9a0", "#a3271b")]
    {
        if field.len() > 2 {
            let path = view.path(field.iter().copied(), "z");
            let _ = write!(svg, "<path d=\"{path}\" fill=\"{fill}\" stroke=\"{edge}\" opacity=\".6\"/>");
        }
    }
    let to_robot = moment.pose.pose_in_odometry.inverse();
    let place = |pose: Pose2| to_robot.transform(Point2::new(pose.x_m, pose.y_m));
    let trail = view.path(snapshots.iter().map(|snapshot| place(snapshot.pose.pose_in_odometry)), "");
    let _ = write!(
        svg,
        "<path d=\"{trail}\" fill=\"none\" stroke=\"#0b5394\" stroke-width=\"2\" stroke-dasharray=\"5 4\"/>"
    );
    let body = view.path(around.footprint.iter().copied(), "z");
    let nose = view.path([Point2::new(0.0, 0.0), Point2::new(0.35, 0.0)].into_iter(), "");
    let _ = write!(
        svg,
        "<path d=\"{body}\" fill=\"#0b5394\"/><path d=\"{nose}\" stroke=\"#fff\" stroke-width=\"3\"/>"
    );
    scan(&mut svg, &view, moment);
    people(&mut svg, &view, snapshots, holder);
    if let Some(holder) = holder {
        ring(&mut svg, &view, (holder, language));
    }
    svg + "</svg>"
}

/// A line each metre, and a bar of one metre.
fn grid(svg: &mut String, view: &View) {
    let whole = view.around_m.floor() as i32;
    let edge = view.around_m;
    let mut lines = String::new();
    for metre in -whole..=whole {
        let at_m = metre as f32;
        lines += &view.path([Point2::new(-edge, at_m), Point2::new(edge, at_m)].into_iter(), "");
        lines += &view.path([Point2::new(at_m, -edge), Point2::new(at_m, edge)].into_iter(), "");
    }
    let metre_px = PX / (2.0 * edge);
    let _ = write!(
        svg,
        "<path d=\"{lines}\" stroke=\"#e8ecf0\"/><path d=\"M12 {y}h{metre_px:.1}\" stroke=\"#1c2733\" stroke-width=\"3\"/>\
         <text x=\"12\" y=\"{text_y}\" font-size=\"14\" fill=\"#1c2733\">1 m</text>",
        y = PX - 12.0,
        text_y = PX - 18.0
    );
}

fn scan(svg: &mut String, view: &View, moment: &Snapshot) {
    let mut dots = String::new();
    for hit in moment.around.hits.iter().filter(|hit| hit.norm() < view.around_m * 1.5) {
        let (x, y) = view.at(*hit);
        let _ = write!(dots, "M{x:.1} {y:.1}h0");
    }
    let _ = write!(
        svg,
        "<path d=\"{dots}\" stroke=\"#1c2733\" stroke-width=\"3.5\" stroke-linecap=\"round\" fill=\"none\"/>"
    );
}

/// Where people are, and where they came from over the ground.
fn people(svg: &mut String, view: &View, snapshots: &[Snapshot], holder: Option<&Holder>) {
    let Some(moment) = snapshots.last() else { return };
    let to_robot = moment.pose.pose_in_odometry.inverse();
    for track in &moment.around.followed {
        let trail = snapshots.iter().filter_map(|snapshot| {
            let then = snapshot.around.followed.iter().find(|other| other.id == track.id)?;
            let over_ground = snapshot.pose.pose_in_odometry.transform(Point2::new(then.x_m, then.y_m));
            Some(to_robot.transform(over_ground))
        });
        let (x, y) = view.at(Point2::new(track.x_m, track.y_m));
        let is_holder = holder.is_some_and(|holder| holder.id == Some(track.id));
        let colour = match (track.person, is_holder) {
            (_, true) => "#a3271b",
            (true, _) => "#b34700",
            (false, _) => "#6b7782",
        };
        let _ = write!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" opacity=\".6\"/><circle cx=\"{x:.1}\" \
             cy=\"{y:.1}\" r=\"{}\" fill=\"{colour}\"/>",
            view.path(trail, ""),
            if track.person { 11 } else { 5 }
        );
        if track.person {
            let _ = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"12\" fill=\"#fff\" text-anchor=\"middle\">{}</text>",
                y + 4.0,
                track.id
            );
        }
    }
}

/// What held the robot, with the line to it and the distance.
fn ring(svg: &mut String, view: &View, (holder, language): (&Holder, Language)) {
    let (x, y) = view.at(Point2::new(holder.x_m, holder.y_m));
    let (from_x, from_y) = view.at(Point2::new(0.0, 0.0));
    // The words stay within the picture.
    let (anchor, text_x) = if x > PX / 2.0 { ("end", x - 18.0) } else { ("start", x + 18.0) };
    let text_y = (y - 18.0).clamp(18.0, PX - 34.0);
    let _ = write!(
        svg,
        "<path d=\"M{from_x:.1} {from_y:.1}L{x:.1} {y:.1}\" stroke=\"#a3271b\" stroke-width=\"2\" stroke-dasharray=\"2 4\"/>\
         <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"16\" fill=\"none\" stroke=\"#a3271b\" stroke-width=\"4\"/><text \
         x=\"{text_x:.1}\" y=\"{text_y:.1}\" font-size=\"16\" font-weight=\"600\" fill=\"#a3271b\" text-anchor=\"{anchor}\" \
         paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"4\">{}</text>",
        holder.words_in(language)
    );
}
