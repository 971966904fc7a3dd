//! Samples of any inertial sensor as a bridge sends them (book, IMU link).

use super::lidar_link::crc32;

/// What a frame of samples begins with.
pub const IMU_START: &[u8] = b"FG\x01\x06";
/// Bytes before the samples.
pub const IMU_HEAD_BYTES: usize = 28;

/// A frame of samples: rates, accelerations, flags; forward, left, up.
#[must_use]
pub fn imu_link_frame(
    (sender, sequence): (u32, u32),
    (first_us, between_us): (u64, u32),
    samples: &[([f32; 3], [f32; 3], u8)],
) -> Vec<u8> {
    let mut bytes = IMU_START.to_vec();
    bytes.extend([sender, sequence].map(u32::to_le_bytes).concat());
    bytes.extend(first_us.to_le_bytes());
    bytes.extend(between_us.to_le_bytes());
    bytes.extend([samples.len() as u8, 0, 0, 0]);
    for (rates, accelerations, flags) in samples {
        bytes.extend(rates.iter().chain(accelerations).flat_map(|value| value.to_le_bytes()));
        bytes.extend([*flags, 0, 0, 0]);
    }
    let checksum = crc32(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the reference encoder in Python prints.
    #[test]
    fn frame_equals_that_of_the_reference() {
        let samples = [([0.5, -0.25, 0.125], [1.5, -2.5, 9.75], 0), ([0.0, 0.0, -1.0], [0.0, 0.0, 10.0], 1)];
        let frame = imu_link_frame((7, 42), (1_000_000_123, 10_000), &samples);
        let hex: String = frame.iter().map(|byte| format!("{byte:02x}")).collect();
        let printed = "46470106070000002a0000007bca9a3b0000000010270000020000000000003f000080be0000003e0000c03f000020c000001c41000000000000000000000000000080bf00000000000000000000204101000000688be575";
        assert_eq!(hex, printed);
    }
}
