//! Frames of the maker's document, and those of an open decoder's own tests (packed by Python's `struct`, values 20620, 12.3 A, 6.5 %;
//! 45.1 °C, 37.2 °C, 8.7 A; 123456 steps, 16.4 V).

use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;

fn decoded(id: u32, payload: &[u8]) -> Option<VescMessage> {
    VescMessage::decode(&CanFrame::extended(id, payload).unwrap())
}

#[test]
fn orders_equal_the_vectors() {
    // The document's example: CAN_PACKET_SET_CURRENT, 51 A, controller 23.
    let frame = VescOrder::Current(51.0).frame(23);
    assert_eq!(frame, CanFrame::extended(0x0117, &[0x00, 0x00, 0xC7, 0x38]).unwrap());
    // The document's C code for the other two: the number itself, highest byte first.
    let frame = VescOrder::ElectricalRpm(-3_000).frame(5);
    assert_eq!(frame, CanFrame::extended(0x0305, &[0xFF, 0xFF, 0xF4, 0x48]).unwrap());
    let frame = VescOrder::Brake(2.5).frame(255);
    assert_eq!(frame, CanFrame::extended(0x02FF, &[0x00, 0x00, 0x09, 0xC4]).unwrap());
    assert_eq!(VescOrder::Current(f32::NAN).frame(1), VescOrder::Current(0.0).frame(1));
}

#[test]
fn reports_equal_the_vectors() {
    let Some(VescMessage { node: 7, report: VescReport::Motion { electrical_rpm, current_a, duty } }) =
        decoded(0x0907, &[0x00, 0x00, 0x50, 0x8C, 0x00, 0x7B, 0x00, 0x41])
    else {
        panic!()
    };
    assert!(electrical_rpm == 20_620 && (current_a - 12.3).abs() < 1e-4 && (duty - 0.065).abs() < 1e-6);
    let Some(VescMessage { report: VescReport::Warmth { transistors_c, motor_c, supply_a }, .. }) =
        decoded(0x1007, &[0x01, 0xC3, 0x01, 0x74, 0x00, 0x57, 0x00, 0xFA])
    else {
        panic!()
    };
    assert!((transistors_c - 45.1).abs() < 1e-4 && (motor_c - 37.2).abs() < 1e-4);
    assert!((supply_a - 8.7).abs() < 1e-4);
    let Some(VescMessage { report: VescReport::Place { steps, supply_v }, .. }) =
        decoded(0x1B07, &[0x00, 0x01, 0xE2, 0x40, 0x00, 0xA4])
    else {
        panic!()
    };
    assert!(steps == 123_456 && (supply_v - 16.4).abs() < 1e-4);
    assert!(matches!(
        decoded(0x0E07, &[0, 0, 0x27, 0x10, 0, 0, 0x13, 0x88]),
        Some(VescMessage { report: VescReport::Charge { used_ah: 1.0, charged_ah: 0.5 }, .. })
    ));
    // Short, of another kind, with eleven bits of identifier, or with something in the bits that are unused.
    assert_eq!(decoded(0x0907, &[0; 7]), None);
    assert_eq!(decoded(0x1C07, &[0; 8]), None);
    assert_eq!(VescMessage::decode(&CanFrame::standard(0x107, &[0; 8])), None);
    assert_eq!(decoded(0x0001_0907, &[0; 8]), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_frame_gives_values_or_nothing(id in 0_u32..0x2000_0000, data in proptest::collection::vec(any::<u8>(), 0..=8)) {
        if let Some(message) = decoded(id, &data) {
            prop_assert_eq!(u32::from(message.node), id & 0xFF);
        }
    }
}
