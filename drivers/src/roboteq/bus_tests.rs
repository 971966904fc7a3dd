//! Frames of the maker's document, and those that the Python package `canopen` 2.4.1 makes of the maker's file
//! `roboteq_motor_controllers_v80.eds` (2021-12-14) for node 12: nobody here wrote that encoder.

use std::vec::Vec;

use proptest::prelude::*;

use super::bus::*;
use crate::can::CanFrame;
use crate::canopen::Script;

/// Roboteq, "CANBus Networking Manual" V2.0, SDO Example 2: EX for node 12. The maker leaves the lowest two bits of the command at 0 and
/// says that they are not needed; CiA 301 wants them.
#[test]
fn emergency_stop_is_that_of_the_manual() {
    let [id, payload] = [&0x60C_u16.to_be_bytes()[..], &[0x2C, 0x0C, 0x20, 0x00, 0x01, 0x00, 0x00, 0x00]];
    let frame = RoboteqBusOrder::EmergencyStop.frame(12);
    let mut sent = frame.payload().to_vec();
    sent[0] &= !3;
    assert_eq!((frame.standard_id().unwrap().to_be_bytes().as_slice(), sent.as_slice()), (id, payload));
}

#[test]
fn orders_equal_the_vectors() {
    let speeds = |first, second| RoboteqBusOrder::Speeds { rpm: [first, second], channels: 2 };
    let table: [(RoboteqBusOrder, u16, [u8; 8]); 4] = [
        (RoboteqBusOrder::EmergencyStop, 0x60C, [0x2F, 0x0C, 0x20, 0, 1, 0, 0, 0]),
        (RoboteqBusOrder::Release, 0x60C, [0x2F, 0x0D, 0x20, 0, 1, 0, 0, 0]),
        (speeds(-120, 2_500), 0x20C, [0x88, 0xFF, 0xFF, 0xFF, 0xC4, 0x09, 0, 0]),
        (speeds(i32::MIN, i32::MAX), 0x20C, [0, 0, 0, 0x80, 0xFF, 0xFF, 0xFF, 0x7F]),
    ];
    for (order, id, payload) in table {
        assert_eq!(order.frame(12), CanFrame::standard(id, &payload), "{order:?}");
    }
    let one = RoboteqBusOrder::Speeds { rpm: [-120, 7], channels: 1 };
    assert_eq!(one.frame(12), CanFrame::standard(0x20C, &[0x88, 0xFF, 0xFF, 0xFF]));
}

#[test]
fn reports_equal_the_vectors() {
    let state = |faults, status, watchdog_ms| RoboteqBusReport::State { faults, status, watchdog_ms };
    let table: [(u16, [u8; 8], RoboteqBusReport); 4] = [
        (0x18C, [0, 0, 0, 0x80, 0xFF, 0xFF, 0xFF, 0x7F], RoboteqBusReport::Counts([i32::MIN, i32::MAX])),
        (0x28C, [0x88, 0xFF, 0xFF, 0xFF, 0xC4, 0x09, 0, 0], RoboteqBusReport::Speeds([-120, 2_500])),
        (0x38C, [0x10, 0, 0x81, 0, 0xC8, 0, 0, 0], state(0x10, 0x81, 200)),
        (0x38C, [0x44, 0, 0x08, 0, 0xFF, 0xFF, 0xFF, 0xFF], state(0x44, 0x08, -1)),
    ];
    for (id, payload, report) in table {
        assert_eq!(RoboteqBusReport::decode(&CanFrame::standard(id, &payload), 2), Some((12, report)));
        for length in 0..8 {
            assert_eq!(RoboteqBusReport::decode(&CanFrame::standard(id, &payload[..length]), 2), None);
        }
    }
    let one = CanFrame::standard(0x28C, &[0x88, 0xFF, 0xFF, 0xFF]);
    assert_eq!(RoboteqBusReport::decode(&one, 1), Some((12, RoboteqBusReport::Speeds([-120, 0]))));
    assert_eq!(RoboteqBusReport::decode(&CanFrame::extended(0x28C, &[0; 8]).unwrap(), 2), None);
}

fn frames(script: &Script) -> Vec<[u8; 8]> {
    let steps = (0..script.len()).filter_map(|number| script.step(number));
    steps.map(|step| *step.frame(12).payload().first_chunk::<8>().unwrap()).collect()
}

/// What the package sends, in its order; of RPDO1 the order is that of [`Script::receive`].
#[test]
fn configuration_equals_the_vectors() {
    let script = bus_script(12, 2);
    assert!(!script.overflowed());
    let sent = frames(&script);
    let begin: [[u8; 8]; 3] = [
        [0x2F, 0x0C, 0x20, 0, 1, 0, 0, 0],
        [0x23, 0x05, 0x20, 1, 0, 0, 0, 0],
        [0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0],
    ];
    let speeds: [[u8; 8]; 7] = [
        [0x23, 0, 0x14, 1, 0x0C, 0x02, 0, 0x80],
        [0x2F, 0, 0x14, 2, 0xFF, 0, 0, 0],
        [0x2F, 0, 0x16, 0, 0, 0, 0, 0],
        [0x23, 0, 0x16, 1, 0x20, 0x01, 0x02, 0x20],
        [0x23, 0, 0x16, 2, 0x20, 0x02, 0x02, 0x20],
        [0x2F, 0, 0x16, 0, 2, 0, 0, 0],
        [0x23, 0, 0x14, 1, 0x0C, 0x02, 0, 0],
    ];
    let reports: [[u8; 8]; 25] = [
        [0x23, 0, 0x18, 1, 0x8C, 0x01, 0, 0xC0],
        [0x2F, 0, 0x18, 2, 0xFF, 0, 0, 0],
        [0x2B, 0, 0x18, 5, 0x0A, 0, 0, 0],
        [0x2F, 0, 0x1A, 0, 0, 0, 0, 0],
        [0x23, 0, 0x1A, 1, 0x20, 0x01, 0x04, 0x21],
        [0x23, 0, 0x1A, 2, 0x20, 0x02, 0x04, 0x21],
        [0x2F, 0, 0x1A, 0, 2, 0, 0, 0],
        [0x23, 0, 0x18, 1, 0x8C, 0x01, 0, 0x40],
        [0x23, 1, 0x18, 1, 0x8C, 0x02, 0, 0xC0],
        [0x2F, 1, 0x18, 2, 0xFF, 0, 0, 0],
        [0x2B, 1, 0x18, 5, 0x0A, 0, 0, 0],
        [0x2F, 1, 0x1A, 0, 0, 0, 0, 0],
        [0x23, 1, 0x1A, 1, 0x20, 0x01, 0x03, 0x21],
        [0x23, 1, 0x1A, 2, 0x20, 0x02, 0x03, 0x21],
        [0x2F, 1, 0x1A, 0, 2, 0, 0, 0],
        [0x23, 1, 0x18, 1, 0x8C, 0x02, 0, 0x40],
        [0x23, 2, 0x18, 1, 0x8C, 0x03, 0, 0xC0],
        [0x2F, 2, 0x18, 2, 0xFF, 0, 0, 0],
        [0x2B, 2, 0x18, 5, 0x14, 0, 0, 0],
        [0x2F, 2, 0x1A, 0, 0, 0, 0, 0],
        [0x23, 2, 0x1A, 1, 0x10, 0, 0x12, 0x21],
        [0x23, 2, 0x1A, 2, 0x10, 0, 0x11, 0x21],
        [0x23, 2, 0x1A, 3, 0x20, 0x01, 0x06, 0x21],
        [0x2F, 2, 0x1A, 0, 3, 0, 0, 0],
        [0x23, 2, 0x18, 1, 0x8C, 0x03, 0, 0x40],
    ];
    assert_eq!(sent[..3], begin);
    assert_eq!((sent[3], sent[9]), (speeds[0], speeds[6]));
    let mut middle = (sent[3..10].to_vec(), speeds.to_vec());
    middle.0.sort_unstable();
    middle.1.sort_unstable();
    assert_eq!(middle.0, middle.1);
    assert_eq!(sent[10..], reports);
    // A controller of one channel has no objects of a second.
    let one = frames(&bus_script(12, 1));
    assert!(
        one.iter().all(|frame| !frame.ends_with(&[0x20, 0x02, 0x02, 0x20]) && frame[6..] != [0x04, 0x02])
    );
    assert_eq!(sent.len() - one.len(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_frame_gives_values_or_nothing(
        id in 0_u16..0x800,
        channels in 0_usize..4,
        data in proptest::collection::vec(any::<u8>(), 0..=8),
    ) {
        if let Some((node, _)) = RoboteqBusReport::decode(&CanFrame::standard(id, &data), channels) {
            prop_assert_eq!(u16::from(node), id & 0x7F);
        }
    }

    #[test]
    fn speeds_come_back(first in any::<i32>(), second in any::<i32>()) {
        let order = RoboteqBusOrder::Speeds { rpm: [first, second], channels: 2 };
        let answered = CanFrame::standard(0x281, order.frame(1).payload());
        prop_assert_eq!(
            RoboteqBusReport::decode(&answered, 2),
            Some((1, RoboteqBusReport::Speeds([first, second])))
        );
    }
}
