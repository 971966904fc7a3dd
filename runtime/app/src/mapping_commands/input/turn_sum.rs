//! What a gyroscope turned: the clock by which scans are judged.

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::OdometryTrack;

/// The sum is kept this often, seconds; between two of them a robot turns evenly.
const KEPT_EVERY_S: f64 = 0.02;
/// Stamps are rounded to microseconds.
const ROUNDED_S: f64 = 1.0e-6;

/// The sum of all turns about the axes of a gyroscope. Its mounting may be known later: a fixed rotation of the sum is the sum of the
/// rotated rates, as long as the robot stays upright.
#[derive(Debug, Default)]
pub struct TurnSum {
    last: Option<(f64, [f64; 3])>,
    sum_rad: [f64; 3],
    kept: Vec<(f64, [f32; 3])>,
}

impl TurnSum {
    /// A sample, rad/s at its stamp; one that is not later or not finite is left out.
    pub fn push(&mut self, time_s: f64, rate_radps: [f32; 3]) {
        let rate_radps = rate_radps.map(f64::from);
        if !rate_radps.iter().all(|rate| rate.is_finite()) {
            return;
        }
        if let Some((last_s, before)) = self.last {
            if time_s <= last_s {
                return;
            }
            let rates = before.iter().zip(rate_radps);
            let turns = rates.map(|(before, now)| 0.5 * (before + now) * (time_s - last_s));
            self.sum_rad.iter_mut().zip(turns).for_each(|(sum, turn)| *sum += turn);
        }
        self.last = Some((time_s, rate_radps));
        if self.kept.last().is_none_or(|(kept_s, _)| time_s - kept_s > KEPT_EVERY_S - ROUNDED_S) {
            self.kept.push((time_s, self.sum_rad.map(|sum| sum as f32)));
        }
    }

    /// The heading over time of the robot whose vertical axis is this one in the gyroscope's axes.
    pub fn headings(&self, up_in_gyroscope: [f32; 3]) -> OdometryTrack {
        let mut track = OdometryTrack::default();
        for (time_s, turned_rad) in &self.kept {
            let parts = turned_rad.iter().zip(up_in_gyroscope);
            let heading_rad: f64 = parts.map(|(turned, up)| f64::from(*turned) * f64::from(up)).sum();
            track.push(*time_s, Se2::new(0.0, 0.0, heading_rad));
        }
        track
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gyroscope on its side: its y axis points down. Samples at 400 Hz of a rate that rises; one is not finite, one late.
    #[test]
    fn turns_about_the_vertical_axis_are_summed() {
        let mut turns = TurnSum::default();
        for step in 0..=400 {
            let time_s = f64::from(step) / 400.0;
            turns.push(time_s, [0.3, -time_s as f32, 0.1]);
            turns.push(time_s - 0.5, [9.0; 3]);
            turns.push(time_s + 0.001, [f32::NAN; 3]);
        }
        let track = turns.headings([0.0, -1.0, 0.0]);
        for time_s in [0.1, 0.503, 0.99] {
            let turned_rad = track.at(time_s).unwrap().heading_rad;
            assert!((turned_rad - 0.5 * time_s * time_s).abs() < 1.0e-4, "{time_s}: {turned_rad}");
        }
    }
}
