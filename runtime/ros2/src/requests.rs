//! What a program outside asks of the robot, beside velocities.

use floorguard_recording::cdr::Decoder;
use floorguard_types::geometry::Pose2;

/// An errand or a button.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RosRequest {
    /// The robot stands until it is to go on.
    Pause,
    /// It goes on.
    Resume,
    /// The guard is asked to release a stop that needs a person.
    Reset,
    /// To drive there, in the map's frame.
    Goal(Pose2),
    /// The robot is there, in the map's frame.
    Relocate(Pose2),
}

/// The only frame in which a place is taken.
const FRAME: &str = "map";
/// Places further away are mistakes, metres.
const PLACE_MAX_M: f64 = 100_000.0;

/// The place of `geometry_msgs/msg/PoseStamped` and of `PoseWithCovarianceStamped`, on the plane. `None`: damaged, in another frame,
/// or no place.
pub fn place(message: &[u8]) -> Option<Pose2> {
    let mut decoder = Decoder::new(message)?;
    let (_, _, frame) = (decoder.i32()?, decoder.u32()?, decoder.text()?);
    let [x_m, y_m, _] = decoder.f64s::<3>()?;
    let [x, y, z, w] = decoder.f64s::<4>()?;
    let norm = x * x + y * y + z * z + w * w;
    let is_place = x_m.abs() <= PLACE_MAX_M && y_m.abs() <= PLACE_MAX_M && (0.5..2.0).contains(&norm);
    let heading_rad = libm::atan2(2.0 * (w * z + x * y), norm - 2.0 * (y * y + z * z));
    (is_place && frame.trim_start_matches('/') == FRAME)
        .then(|| Pose2::new(x_m as f32, y_m as f32, heading_rad as f32))
}

#[cfg(test)]
mod tests {
    use floorguard_recording::cdr::Encoder;

    use super::*;

    fn pose(frame: &str, numbers: [f64; 7]) -> Vec<u8> {
        let mut encoder = Encoder::new();
        encoder.i32(1).u32(2).text(frame).f64s(&numbers);
        encoder.finish()
    }

    #[test]
    fn place_on_the_map_is_read() {
        let half = core::f64::consts::FRAC_PI_4;
        let found =
            place(&pose("map", [3.0, -1.5, 0.2, 0.0, 0.0, libm::sin(half), libm::cos(half)])).unwrap();
        assert_eq!((found.x_m, found.y_m), (3.0, -1.5));
        assert!((found.heading_rad - core::f32::consts::FRAC_PI_2).abs() < 1.0e-6);
    }

    #[test]
    fn other_frames_and_damage_are_refused() {
        let good = [3.0, -1.5, 0.0, 0.0, 0.0, 0.0, 1.0];
        let whole = pose("map", good);
        assert!(place(&whole).is_some());
        assert_eq!(place(&pose("odom", good)), None);
        assert_eq!(place(&pose("map", [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])), None);
        assert_eq!(place(&pose("map", [1.0e9, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])), None);
        assert_eq!(place(&pose("map", [0.0; 7])), None, "no rotation at all");
        assert!((0..whole.len()).all(|cut| place(&whole[..cut]).is_none()));
    }
}
