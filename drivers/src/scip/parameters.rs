//! What a sensor says of itself (`PP`).

use core::f32::consts::TAU;

use floorguard_types::number::{nearest_f32, saturating_u16_of_u32};
use floorguard_types::sensing::BeamReturn;

use super::encoding::decimal;

/// Geometry, ranges and speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorParameters {
    /// Nearest distance, millimetres: smaller numbers are error codes.
    pub nearest_mm: u32,
    /// Farthest distance, millimetres.
    pub farthest_mm: u32,
    /// Steps of a whole turn, > 0.
    pub steps_per_turn: u16,
    /// First step that is measured.
    pub first_step: u16,
    /// Last step that is measured.
    pub last_step: u16,
    /// Step that looks to the front.
    pub front_step: u16,
    /// Turns a minute, > 0.
    pub turns_per_minute: u16,
}

impl SensorParameters {
    /// URG-04LX (specification of SCIP 2.0, section 8.12: Example); 4 m is what its maker warrants, 5.6 m what it sends.
    pub const URG_04LX: Self = Self {
        nearest_mm: 20,
        farthest_mm: 5_600,
        steps_per_turn: 1_024,
        first_step: 44,
        last_step: 725,
        front_step: 384,
        turns_per_minute: 600,
    };
    /// UST-10LX.
    pub const UST_10LX: Self = Self {
        nearest_mm: 20,
        farthest_mm: 30_000,
        steps_per_turn: 1_440,
        first_step: 0,
        last_step: 1_080,
        front_step: 540,
        turns_per_minute: 2_400,
    };

    /// Angle from step to step, radians.
    #[must_use]
    pub fn step_rad(&self) -> f32 {
        TAU / nearest_f32(self.steps_per_turn.max(1))
    }

    /// Angle of a step, radians; 0 is the front, counter-clockwise positive.
    #[must_use]
    pub fn angle_rad(&self, step: u16) -> f32 {
        (f32::from(step) - f32::from(self.front_step)) * self.step_rad()
    }

    /// Time from step to step, microseconds.
    #[must_use]
    pub fn step_us(&self) -> f32 {
        6.0e7 / (f32::from(self.turns_per_minute.max(1)) * f32::from(self.steps_per_turn.max(1)))
    }

    /// What a number means: a distance, or nothing known. Error codes, distances below the nearest and beyond the farthest, and
    /// what millimetres in 16 bits do not hold say nothing: an error is never clear.
    #[must_use]
    pub fn beam(&self, distance_mm: u32) -> BeamReturn {
        if !(self.nearest_mm..=self.farthest_mm).contains(&distance_mm) {
            return BeamReturn::Unknown;
        }
        u16::try_from(distance_mm).map_or(BeamReturn::Unknown, BeamReturn::Hit)
    }

    /// Takes a line of the sensor's answer, `KEY:value` (without semicolon and check character). Other keys are passed over.
    pub(super) fn take(&mut self, line: &[u8]) {
        let Some((key, value)) = line.split_first_chunk::<5>() else { return };
        let Some(number) = decimal(value.trim_ascii()) else { return };
        let short = saturating_u16_of_u32(number);
        match key {
            b"DMIN:" => self.nearest_mm = number,
            b"DMAX:" => self.farthest_mm = number,
            b"ARES:" => self.steps_per_turn = short,
            b"AMIN:" => self.first_step = short,
            b"AMAX:" => self.last_step = short,
            b"AFRT:" => self.front_step = short,
            b"SCAN:" => self.turns_per_minute = short,
            _ => {}
        }
    }

    /// They are possible: a sensor that says otherwise is none that we can use.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        (64..=16_384).contains(&self.steps_per_turn)
            && self.first_step < self.last_step
            && self.last_step <= self.steps_per_turn
            && (60..=12_000).contains(&self.turns_per_minute)
            && self.nearest_mm < self.farthest_mm
    }

    /// Nothing known: not plausible.
    pub(super) const NONE: Self = Self {
        nearest_mm: 0,
        farthest_mm: 0,
        steps_per_turn: 0,
        first_step: 0,
        last_step: 0,
        front_step: 0,
        turns_per_minute: 0,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of the specification's example.
    #[test]
    fn published_lines_are_understood() {
        let mut found = SensorParameters::NONE;
        assert!(!found.is_plausible());
        let lines =
            ["MODL:URG-04LX(Hokuyo Automatic Co., Ltd.)", "DMIN:20", "DMAX:5600", "ARES:1024", "AMIN:44"];
        for line in lines.iter().chain(&["AMAX:725", "AFRT:384", "SCAN:600", "AMAX:", "XX"]) {
            found.take(line.as_bytes());
        }
        assert_eq!(found, SensorParameters::URG_04LX);
        assert!(found.is_plausible() && SensorParameters::UST_10LX.is_plausible());
        // 0.0976562 ms and 0.00613592 rad from step to step, as other programs print for this sensor.
        assert!((found.step_us() - 97.656_2).abs() < 1e-3);
        assert!((found.step_rad() - 0.006_135_92).abs() < 1e-7);
        assert!(
            (found.angle_rad(44) + 2.086_21).abs() < 1e-4 && (found.angle_rad(725) - 2.092_35).abs() < 1e-4
        );
    }

    #[test]
    fn error_codes_are_unknown() {
        let urg = SensorParameters::URG_04LX;
        for code in (0..20).chain([5_601, 65_533, 65_535, 65_536, 262_143]) {
            assert_eq!(urg.beam(code), BeamReturn::Unknown, "{code}");
        }
        assert_eq!((urg.beam(20), urg.beam(5_600)), (BeamReturn::Hit(20), BeamReturn::Hit(5_600)));
        let far = SensorParameters { farthest_mm: 100_000, ..urg };
        assert_eq!(far.beam(70_000), BeamReturn::Unknown);
    }
}
