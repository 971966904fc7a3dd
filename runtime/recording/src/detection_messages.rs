//! People as detections, for programs that read `vision_msgs` rather than markers, and the clock on the wall.

use floorguard_runtime::shared::{PeopleReport, PersonReport};
use floorguard_types::time::Stamp;

use super::cdr::Encoder;
use super::describe;
use super::messages::{header, quaternion_about_z};

/// Classes of the hypotheses.
const PERSON: &str = "person";
const OBJECT: &str = "object";
/// The frame of the tracks.
const FRAME: &str = "odom";

/// `vision_msgs/msg/Detection3DArray` of all tracks of a sweep, in the odometry frame: box, class and probability, with the variance
/// of the place. An `id` is the track's number.
pub fn detections(stamp: Stamp, report: &PeopleReport) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, FRAME);
    encoder.length(report.people.len());
    report.people.iter().for_each(|track| detection(&mut encoder, stamp, track));
    encoder.finish()
}

fn detection(encoder: &mut Encoder, stamp: Stamp, track: &PersonReport) {
    let is_person = describe::is_person(track);
    let size_m = describe::body_size_m(is_person);
    let heading_rad = libm::atan2f(track.velocity_mps.y_m, track.velocity_mps.x_m);
    header(encoder, stamp, FRAME);
    // One hypothesis.
    encoder.length(1).text(if is_person { PERSON } else { OBJECT });
    let probability = f64::from(track.person_probability);
    encoder.f64(if is_person { probability } else { 1.0 - probability });
    pose(encoder, (track, size_m[2], heading_rad));
    let variance_m2 = f64::from(track.position_sigma_m) * f64::from(track.position_sigma_m);
    let mut covariance = [0.0; 36];
    if variance_m2 > 0.0 {
        (covariance[0], covariance[7]) = (variance_m2, variance_m2);
    } else {
        covariance[0] = -1.0;
    }
    encoder.f64s(&covariance);
    pose(encoder, (track, size_m[2], heading_rad));
    encoder.f64s(&size_m);
    encoder.text(&track.id.to_string());
}

/// `geometry_msgs/Pose` of the middle of a body.
fn pose(encoder: &mut Encoder, (track, height_m, heading_rad): (&PersonReport, f64, f32)) {
    encoder.f64s(&[f64::from(track.position.x_m), f64::from(track.position.y_m), height_m / 2.0]);
    quaternion_about_z(encoder, heading_rad);
}

/// `sensor_msgs/msg/TimeReference`: a moment of the robot's clock, and what the clock on the wall showed then, microseconds since 1970.
pub fn wall_clock(stamp: Stamp, unix_us: u64) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, "");
    encoder.time(Stamp::from_micros(unix_us)).text("the computer's clock");
    encoder.finish()
}

#[cfg(test)]
mod tests {
    use floorguard_runtime::shared::SweepReport;

    use super::*;
    use crate::cdr::Decoder;

    #[test]
    fn wall_clock_stands_beside_robots_clock() {
        let message = wall_clock(Stamp::from_micros(1_500_000), 1_790_000_000_250_000);
        let mut decoder = Decoder::new(&message).unwrap();
        assert_eq!((decoder.i32(), decoder.u32()), (Some(1), Some(500_000_000)));
        assert_eq!(decoder.text().as_deref(), Some(""));
        assert_eq!((decoder.i32(), decoder.u32()), (Some(1_790_000_000), Some(250_000_000)));
    }

    #[test]
    fn no_tracks_are_an_empty_list() {
        let report = PeopleReport {
            sweep: SweepReport::default(),
            people: Default::default(),
            unposed_sweeps: 0,
            unposed_scans: 0,
        };
        let message = detections(Stamp::ZERO, &report);
        assert_eq!(message.len(), 4 + 4 + 4 + 4 + 5 + 3 + 4);
    }
}
