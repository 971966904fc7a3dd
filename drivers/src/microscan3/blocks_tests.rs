//! Each bit of the state and of a beam has one meaning (book, microScan3: Blocks).

use super::blocks::{BeamStatus, DeviceStatus};

#[test]
fn each_bit_of_a_beam_has_one_meaning() {
    type Meaning = fn(BeamStatus) -> bool;
    let meanings: [Meaning; 6] = [
        BeamStatus::is_valid,
        BeamStatus::is_infinite,
        BeamStatus::has_glare,
        BeamStatus::is_reflector,
        BeamStatus::is_contaminated,
        BeamStatus::warns_of_contamination,
    ];
    for (number, meaning) in meanings.iter().enumerate() {
        let bit = 1_u8 << number;
        assert!(meaning(BeamStatus(bit)) && meaning(BeamStatus(0xFF)), "bit {number}");
        assert!(!meaning(BeamStatus(!bit)) && !meaning(BeamStatus(0)), "bit {number}");
    }
}

#[test]
fn each_bit_of_the_device_has_one_meaning() {
    type Meaning = fn(DeviceStatus) -> bool;
    let meanings: [(usize, Meaning); 8] = [
        (0, DeviceStatus::runs),
        (1, DeviceStatus::stands_by),
        (2, DeviceStatus::warns_of_contamination),
        (3, DeviceStatus::is_contaminated),
        (4, DeviceStatus::contour_moved),
        (5, DeviceStatus::is_manipulated),
        (120, DeviceStatus::has_application_error),
        (121, DeviceStatus::has_device_error),
    ];
    for (bit, meaning) in meanings {
        let mut bytes = [0; 16];
        bytes[bit / 8] = 1 << (bit % 8);
        assert!(meaning(DeviceStatus::new_checked(&bytes).unwrap()), "bit {bit}");
        let others = bytes.map(|byte: u8| !byte);
        assert!(!meaning(DeviceStatus::new_checked(&others).unwrap()), "bit {bit}");
    }
}

#[test]
fn paths_and_cases_stand_where_they_stand() {
    let bytes = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    let status = DeviceStatus::new_checked(&bytes).unwrap();
    assert_eq!((status.safe_paths(), status.other_paths()), (0x03_0201, 0x06_0504));
    assert_eq!((status.reset_required(), status.monitoring_cases()), (0x09_0807, [10, 11, 12, 13]));
    assert_eq!(DeviceStatus::new_checked(&bytes[..15]), None);
}
