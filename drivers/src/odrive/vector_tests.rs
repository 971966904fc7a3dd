//! Frames that the Python packages `cantools` 45.1.0 and `odrive-can` 2.1.0 make of the maker's DBC file
//! `odrive-cansimple-0.6.10.dbc`: nobody here wrote that encoder.

use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;

#[test]
fn orders_equal_the_vectors() {
    let table: [(u8, OdriveOrder, u16, &[u8]); 6] = [
        (1, OdriveOrder::EmergencyStop, 0x022, &[]),
        (63, OdriveOrder::Idle, 0x7E7, &[1, 0, 0, 0, 0, 0, 0, 0]),
        (1, OdriveOrder::ClosedLoop, 0x027, &[8, 0, 0, 0, 0, 0, 0, 0]),
        (1, OdriveOrder::FollowSpeed, 0x02B, &[2, 0, 0, 0, 1, 0, 0, 0]),
        (1, OdriveOrder::Speed(-1.25), 0x02D, &[0x00, 0x00, 0xA0, 0xBF, 0, 0, 0, 0]),
        (1, OdriveOrder::ClearErrors, 0x038, &[0]),
    ];
    for (node, order, id, payload) in table {
        assert_eq!(order.frame(node), CanFrame::standard(id, payload), "{order:?}");
    }
    assert_eq!(OdriveOrder::Speed(f32::NAN).frame(1), OdriveOrder::Speed(0.0).frame(1));
}

#[test]
fn reports_equal_the_vectors() {
    let heartbeat = |error, state| OdriveReport::Heartbeat { error, state };
    let table: [(u16, &[u8], u8, OdriveReport); 5] = [
        (0x021, &[0, 0, 0, 0, 8, 0, 0, 0], 1, heartbeat(0, AxisState::ClosedLoop)),
        (0x041, &[0, 0, 0, 1, 1, 0, 1, 0], 2, heartbeat(WATCHDOG_EXPIRED, AxisState::Idle)),
        (
            0x069,
            &[0x00, 0x00, 0x46, 0xC1, 0xCD, 0xCC, 0x4C, 0x3F],
            3,
            OdriveReport::Estimates { position_turns: -12.375, speed_turns_per_s: 0.8 },
        ),
        (
            0x023,
            &[0, 0, 0, 2, 0, 0, 0, 1],
            1,
            OdriveReport::Errors { active: 0x0200_0000, disarm_reason: WATCHDOG_EXPIRED },
        ),
        (
            0x037,
            &[0x00, 0x00, 0xC4, 0x41, 0x00, 0x00, 0xC0, 0xBF],
            1,
            OdriveReport::Bus { voltage_v: 24.5, current_a: -1.5 },
        ),
    ];
    for (id, payload, node, report) in table {
        let frame = CanFrame::standard(id, payload);
        assert_eq!(OdriveMessage::decode(&frame), Some(OdriveMessage { node, report }));
        // What is cut is nothing; a heartbeat says all it has to in five bytes.
        let needed = if id & 0x1F == 1 { 5 } else { 8 };
        for length in 0..needed {
            assert_eq!(OdriveMessage::decode(&CanFrame::standard(id, &payload[..length])), None);
        }
    }
    let none = f32::NAN.to_le_bytes();
    assert_eq!(OdriveMessage::decode(&CanFrame::standard(0x069, &[none, none].concat())), None);
    assert_eq!(OdriveMessage::decode(&CanFrame::extended(0x021, &[0; 8]).unwrap()), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_frame_gives_values_or_nothing(id in 0_u16..0x800, data in proptest::collection::vec(any::<u8>(), 0..=8)) {
        if let Some(message) = OdriveMessage::decode(&CanFrame::standard(id, &data)) {
            prop_assert_eq!(u16::from(message.node), id >> 5);
            if let OdriveReport::Estimates { position_turns, speed_turns_per_s } = message.report {
                prop_assert!(position_turns.is_finite() && speed_turns_per_s.is_finite());
            }
        }
    }
}
