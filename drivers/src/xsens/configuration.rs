//! What the robot knows about the device and its line before the first byte.

/// How the device is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviceConfiguration {
    /// Bits per second of the line; a byte takes ten of them. On USB any high number.
    pub baud: u32,
    /// How the product code must begin; empty accepts any device.
    pub product: &'static str,
    /// Samples per second to ask for, 1…400. Halved by the driver when the device says that the line is too slow.
    pub rate_hz: u16,
    /// From the sampling instant to the first byte on the line, µs. The maker says less than 2 ms; half of that is wrong
    /// by at most 1 ms.
    pub latency_us: u64,
}

impl Default for DeviceConfiguration {
    /// An MTi-30 on its factory line: 100 Hz at 115,200 baud (book, Xsens MTi: Frames).
    fn default() -> Self {
        Self { baud: 115_200, product: "MTi-30", rate_hz: 100, latency_us: 1_000 }
    }
}
