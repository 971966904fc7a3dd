//! What the guard does, as the parts of nav2 say it to each other.
//!
//! Source: nav2_msgs 1.3 (Jazzy): `CollisionMonitorState`, `SpeedLimit`; nav2_costmap_2d: `NO_SPEED_LIMIT`.

use floorguard_recording::cdr::Encoder;
use floorguard_types::time::Stamp;

use super::moment::{Restraint, RobotMoment};

/// Numbers of `action_type`.
const DO_NOTHING: u8 = 0;
const STOP: u8 = 1;
const LIMIT: u8 = 4;
/// A limit of zero means to nav2 that there is none, so for a robot that must stand it is this, m/s.
const STANDS_MPS: f32 = 0.01;

/// `nav2_msgs/msg/CollisionMonitorState`: the cause stands where a polygon's name would.
pub fn collision_monitor_state(moment: &RobotMoment) -> Vec<u8> {
    let action = match moment.restraint {
        Restraint::None => DO_NOTHING,
        Restraint::Slows => LIMIT,
        Restraint::Stops => STOP,
    };
    let mut encoder = Encoder::new();
    encoder.u8(action).text(&moment.cause);
    encoder.finish()
}

/// `nav2_msgs/msg/SpeedLimit` in m/s.
pub fn speed_limit(moment: &RobotMoment, stamp: Stamp) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.time(stamp).text("base_link").u8(0).f64(f64::from(limit_mps(moment)));
    encoder.finish()
}

/// The limit that nav2 gets.
pub fn limit_mps(moment: &RobotMoment) -> f32 {
    moment.limit_mps.max(STANDS_MPS)
}

#[cfg(test)]
mod tests {
    use floorguard_recording::cdr::Decoder;

    use super::*;

    #[test]
    fn standing_robot_is_not_reported_as_unlimited() {
        let at = Stamp::from_micros(1_500_000);
        let moment =
            RobotMoment { at, restraint: Restraint::Stops, cause: "field".to_owned(), limit_mps: 0.0 };
        let limit = speed_limit(&moment, at);
        let mut decoder = Decoder::new(&limit).unwrap();
        assert_eq!((decoder.i32(), decoder.u32()), (Some(1), Some(500_000_000)));
        assert_eq!((decoder.text().as_deref(), decoder.u8()), (Some("base_link"), Some(0)));
        assert!(decoder.f64().is_some_and(|limit| limit > 0.0));
        assert_eq!(
            collision_monitor_state(&moment)[4..],
            [1, 0, 0, 0, 6, 0, 0, 0, b'f', b'i', b'e', b'l', b'd', 0]
        );
    }
}
