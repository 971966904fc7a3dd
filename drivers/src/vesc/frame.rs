//! Frames to a controller and from it: 29 bits of identifier, command and controller in the lower two bytes; numbers begin with the
//! highest byte.

use floorguard_types::number::{nearest_f32, saturating_i32};

use crate::can::CanFrame;

/// What a controller sends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VescReport {
    /// `CAN_PACKET_STATUS`, 9.
    Motion {
        /// Electrical revolutions a minute: mechanical ones times the pairs of poles.
        electrical_rpm: i32,
        /// Amperes of the motor.
        current_a: f32,
        /// Share of the supply, −1…1.
        duty: f32,
    },
    /// `CAN_PACKET_STATUS_2`, 14: charge since it was powered, ampere hours.
    Charge {
        /// Taken.
        used_ah: f32,
        /// Given back while braking.
        charged_ah: f32,
    },
    /// `CAN_PACKET_STATUS_3`, 15: energy since it was powered, watt hours.
    Energy {
        /// Taken.
        used_wh: f32,
        /// Given back while braking.
        charged_wh: f32,
    },
    /// `CAN_PACKET_STATUS_4`, 16.
    Warmth {
        /// Of the transistors, °C.
        transistors_c: f32,
        /// Of the motor, °C.
        motor_c: f32,
        /// Amperes from the supply.
        supply_a: f32,
    },
    /// `CAN_PACKET_STATUS_5`, 27.
    Place {
        /// Sixths of an electrical revolution since it was powered.
        steps: i32,
        /// Volts of the supply.
        supply_v: f32,
    },
}

/// A report and the controller it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VescMessage {
    /// Number of the controller.
    pub node: u8,
    /// What it says.
    pub report: VescReport,
}

fn whole(payload: &[u8], at: usize) -> Option<i32> {
    Some(i32::from_be_bytes(*payload.get(at..)?.first_chunk::<4>()?))
}

fn short(payload: &[u8], at: usize) -> Option<f32> {
    Some(nearest_f32(i16::from_be_bytes(*payload.get(at..)?.first_chunk::<2>()?)))
}

impl VescMessage {
    /// Decodes a frame; `None`: of another kind, or too short.
    ///
    /// ```
    /// use floorguard_drivers::can::CanFrame;
    /// use floorguard_drivers::vesc::{VescMessage, VescReport};
    ///
    /// let frame = CanFrame::extended(0x907, &[0, 0, 0x50, 0x8C, 0, 0x7B, 0, 0x41]).unwrap();
    /// let Some(VescMessage { node: 7, report: VescReport::Motion { electrical_rpm, .. } }) = VescMessage::decode(&frame) else {
    ///     panic!()
    /// };
    /// assert_eq!(electrical_rpm, 20_620);
    /// ```
    #[must_use]
    pub fn decode(frame: &CanFrame) -> Option<Self> {
        let [_, 0, command, node] = frame.extended_id()?.to_be_bytes() else { return None };
        let payload = frame.payload();
        let report = match command {
            9 => VescReport::Motion {
                electrical_rpm: whole(payload, 0)?,
                current_a: short(payload, 4)? * 0.1,
                duty: short(payload, 6)? * 1.0e-3,
            },
            14 => VescReport::Charge {
                used_ah: nearest_f32(whole(payload, 0)?) * 1.0e-4,
                charged_ah: nearest_f32(whole(payload, 4)?) * 1.0e-4,
            },
            15 => VescReport::Energy {
                used_wh: nearest_f32(whole(payload, 0)?) * 1.0e-4,
                charged_wh: nearest_f32(whole(payload, 4)?) * 1.0e-4,
            },
            16 => VescReport::Warmth {
                transistors_c: short(payload, 0)? * 0.1,
                motor_c: short(payload, 2)? * 0.1,
                supply_a: short(payload, 4)? * 0.1,
            },
            27 => VescReport::Place { steps: whole(payload, 0)?, supply_v: short(payload, 4)? * 0.1 },
            _ => return None,
        };
        Some(Self { node, report })
    }
}

/// What a controller is commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VescOrder {
    /// `CAN_PACKET_SET_CURRENT`, 1: amperes; 0 lets the motor run free.
    Current(f32),
    /// `CAN_PACKET_SET_CURRENT_BRAKE`, 2: amperes.
    Brake(f32),
    /// `CAN_PACKET_SET_RPM`, 3: electrical revolutions a minute.
    ElectricalRpm(i32),
}

impl VescOrder {
    /// The frame to a controller. A current without value is none.
    ///
    /// ```
    /// use floorguard_drivers::vesc::VescOrder;
    ///
    /// // 51 A to controller 23, as the document has it.
    /// let frame = VescOrder::Current(51.0).frame(23);
    /// assert_eq!((frame.extended_id(), frame.payload()), (Some(0x0117), &[0, 0, 0xC7, 0x38][..]));
    /// ```
    #[must_use]
    pub fn frame(self, node: u8) -> CanFrame {
        let milliamperes = |current_a: f32| saturating_i32(libm::roundf(current_a * 1_000.0));
        let (command, value) = match self {
            Self::Current(current_a) => (1_u32, milliamperes(current_a)),
            Self::Brake(current_a) => (2, milliamperes(current_a)),
            Self::ElectricalRpm(rpm) => (3, rpm),
        };
        let bytes = value.to_be_bytes();
        // Sixteen bits always fit: the fallback is unreachable.
        CanFrame::extended(command << 8 | u32::from(node), &bytes)
            .unwrap_or_else(|| CanFrame::standard(0x7FF, &[]))
    }
}
