//! What the metadata of one sensor say: its packets, and where each of its beams looks.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::count_f32;
use heapless::Vec;

/// Beams of the largest sensor.
pub const CHANNELS_MAX: usize = 128;
/// Columns between the beams that look farthest to either side may be at most this: 11° at 2,048 columns a turn.
pub const SPREAD_MAX: usize = 64;
/// A turn, thousandths of a degree.
const TURN_MDEG: i32 = 360_000;
/// The elevations among which the stages that find people were made: those of a VLP-16, thousandths of a degree.
const WANTED_MDEG: [i32; 2] = [-15_000, 15_000];

/// With fewer rings than this that are new a second look is not worth its time.
const NEW_MIN: usize = 4;

/// How the values of a pixel lie in a packet: `udp_profile_lidar` of the metadata.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DataFormat {
    /// `LEGACY`: 12 bytes a pixel, one echo.
    #[default]
    Legacy,
    /// `RNG19_RFL8_SIG16_NIR16`: 12 bytes a pixel, one echo.
    Single,
    /// `RNG19_RFL8_SIG16_NIR16_DUAL`: 16 bytes a pixel, two echoes.
    Dual,
    /// `RNG15_RFL8_NIR8`: 4 bytes a pixel, one echo in steps of 8 mm.
    LowRate,
}

/// One sensor.
///
/// Numbers are whole thousandths: a robot's file and a recording hold them exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beams {
    /// How its packets are made.
    pub format: DataFormat,
    /// Columns of a turn: 512, 1,024, 2,048 or 4,096.
    pub columns_per_turn: u16,
    /// Columns of a packet.
    pub columns_per_packet: u8,
    /// Beams of a column, 1 to [`CHANNELS_MAX`].
    pub channels: u8,
    /// Elevation of each beam, thousandths of a degree, up is positive.
    pub altitude_mdeg: [i32; CHANNELS_MAX],
    /// Azimuth of each beam from that of its column, thousandths of a degree, clockwise seen from above is positive.
    pub azimuth_mdeg: [i32; CHANNELS_MAX],
    /// From the axis to where the beams leave, micrometres.
    pub beam_origin_um: u32,
}

impl Beams {
    /// Nothing known: no channel.
    pub const NONE: Self = Self {
        format: DataFormat::Legacy,
        columns_per_turn: 1_024,
        columns_per_packet: 16,
        channels: 0,
        altitude_mdeg: [0; CHANNELS_MAX],
        azimuth_mdeg: [0; CHANNELS_MAX],
        beam_origin_um: 0,
    };

    /// Evenly spaced beams from the uppermost down, straight ahead: for tests and examples.
    #[must_use]
    pub fn even(channels: u8, (top_mdeg, bottom_mdeg): (i32, i32)) -> Self {
        let mut beams = Self { channels: channels.clamp(1, 128), ..Self::NONE };
        let steps = i32::from(beams.channels).saturating_sub(1).max(1);
        for (channel, altitude) in (0..=steps).zip(beams.altitude_mdeg.iter_mut()) {
            let down = top_mdeg.saturating_sub(bottom_mdeg).saturating_mul(channel);
            *altitude = top_mdeg.saturating_sub(down.checked_div(steps).unwrap_or(0));
        }
        beams
    }

    /// Elevation of a beam, degrees.
    #[must_use]
    pub fn elevation_deg(&self, channel: u8) -> f32 {
        let mdeg = self.altitude_mdeg.get(usize::from(channel)).copied().unwrap_or(0);
        thousandths(mdeg)
    }

    /// Height of the point from which a beam seems to leave on the axis, metres: the beams leave a little beside it.
    #[must_use]
    pub fn height_m(&self, channel: u8) -> f32 {
        let radians = self.elevation_deg(channel) * floorguard_types::units::RADIANS_PER_DEGREE;
        let origin_m = count_f32(usize::try_from(self.beam_origin_um).unwrap_or(0)) * 1.0e-6;
        -origin_m * libm::sinf(radians)
    }

    /// By how many columns a beam looks ahead of its own column: rounded.
    #[must_use]
    pub fn shift(&self, channel: usize) -> i32 {
        let azimuth = self.azimuth_mdeg.get(channel).copied().unwrap_or(0);
        let columns = azimuth.saturating_mul(i32::from(self.columns_per_turn));
        let half = if columns < 0 { -TURN_MDEG / 2 } else { TURN_MDEG / 2 };
        columns.saturating_add(half) / TURN_MDEG
    }

    /// The beams that become rings, the lowest first, at most so many. Of a sensor with more, those that are nearest to even steps
    /// between −15° and 15° (or the sensor's own limits): what finds people was made for these.
    #[must_use]
    pub fn rings(&self, rings_max: usize) -> Vec<u8, CHANNELS_MAX> {
        let mut upwards = self.upwards();
        let (count, wanted) = (upwards.len(), rings_max.min(CHANNELS_MAX));
        if count <= wanted || wanted < 2 {
            upwards.truncate(wanted);
            return upwards;
        }
        let altitude = |position: usize| {
            let channel = upwards.get(position).copied().unwrap_or(0);
            self.altitude_mdeg.get(usize::from(channel)).copied().unwrap_or(0)
        };
        let [lowest, highest] = WANTED_MDEG;
        let from = lowest.max(altitude(0));
        let to = highest.min(altitude(count.saturating_sub(1))).max(from);
        let mut chosen = Vec::new();
        let mut next = 0;
        for ring in (0..CHANNELS_MAX).take(wanted) {
            let steps = i32::try_from(wanted.saturating_sub(1)).unwrap_or(1).max(1);
            let step = i32::try_from(ring).unwrap_or(0);
            let aim = to.saturating_sub(from).saturating_mul(step).checked_div(steps).unwrap_or(0);
            let aim = from.saturating_add(aim);
            // As many must be left as are still wanted.
            let last = count.saturating_sub(wanted.saturating_sub(ring));
            let left = (0..CHANNELS_MAX).filter(|position| (next..=last).contains(position));
            let nearest = left.min_by_key(|position| altitude(*position).abs_diff(aim));
            let Some(position) = nearest else { break };
            if let Some(channel) = upwards.get(position) {
                // At most the capacity.
                let _full = chosen.push(*channel);
            }
            next = position.saturating_add(1);
        }
        chosen
    }

    /// The beams of a second look for people, the lowest first: sixteen, or none. Between the lowest and the highest of
    /// [`Self::rings`] those that are not among these, the nearest to the horizon first, where people far away are; where
    /// they are fewer, the nearest to the horizon of these as well. None where fewer than four are new.
    #[must_use]
    pub fn second_rings(&self) -> Vec<u8, CHANNELS_MAX> {
        let first = self.rings(SWEEP_RINGS);
        let altitude = |channel: &u8| self.altitude_mdeg.get(usize::from(*channel)).copied().unwrap_or(0);
        let [lowest, highest] = [first.first(), first.last()].map(|channel| channel.map_or(0, altitude));
        let upwards = self.upwards();
        let is_between = |channel: &u8| altitude(channel) >= lowest && altitude(channel) <= highest;
        let is_new = |channel: &&u8| !first.contains(channel) && is_between(channel);
        if upwards.iter().filter(is_new).count() < NEW_MIN {
            return Vec::new();
        }
        let mut chosen: Vec<u8, CHANNELS_MAX> = Vec::new();
        for _ in 0..SWEEP_RINGS {
            let free = || upwards.iter().filter(|channel| !chosen.contains(channel));
            let nearest = |channel: &&u8| altitude(channel).unsigned_abs();
            let new = free().filter(is_new).min_by_key(nearest);
            let next = new.or_else(|| free().filter(|channel| first.contains(channel)).min_by_key(nearest));
            let Some(channel) = next.copied() else { break };
            // Fewer than the capacity.
            let _full = chosen.push(channel);
        }
        let mut rings = Vec::new();
        for channel in upwards.iter().filter(|channel| chosen.contains(*channel)) {
            // As many as chosen.
            let _full = rings.push(*channel);
        }
        rings
    }

    /// All channels, the lowest first.
    fn upwards(&self) -> Vec<u8, CHANNELS_MAX> {
        let mut order = Vec::new();
        let channels = usize::from(self.channels).min(CHANNELS_MAX);
        let mut before: Option<(i32, u8)> = None;
        for _ in (0..CHANNELS_MAX).take(channels) {
            let keys = (0_u8..).zip(self.altitude_mdeg.iter().take(channels));
            let keys = keys.map(|(channel, altitude)| (*altitude, channel));
            let next = keys.filter(|key| before.is_none_or(|before| *key > before)).min();
            let Some((_, channel)) = next else { break };
            before = next;
            // At most the capacity.
            let _full = order.push(channel);
        }
        order
    }

    /// Why packets of such a sensor cannot be decoded: what is wrong.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let channels = usize::from(self.channels);
        let shifts = || (0..CHANNELS_MAX).take(channels).map(|channel| self.shift(channel));
        let spread = shifts().max().unwrap_or(0).abs_diff(shifts().min().unwrap_or(0));
        let is_turn = (256..=4_096).contains(&self.columns_per_turn);
        let per_packet = u16::from(self.columns_per_packet);
        if channels == 0 || channels > CHANNELS_MAX {
            Some("it has no beam, or more than 128")
        } else if !is_turn
            || !(1..=24).contains(&per_packet)
            || !self.columns_per_turn.is_multiple_of(per_packet)
        {
            Some("its columns do not make whole packets of at most 24, and a turn of 256 to 4,096")
        } else if usize::try_from(spread).unwrap_or(usize::MAX) >= SPREAD_MAX {
            Some("its beams look more than 64 columns apart")
        } else if self.altitude_mdeg.iter().any(|altitude| altitude.unsigned_abs() > 89_000) {
            Some("a beam looks up or down by more than 89°")
        } else {
            None
        }
    }
}

/// Degrees of thousandths.
fn thousandths(mdeg: i32) -> f32 {
    // Up to 89,000: exact.
    let size = count_f32(usize::try_from(mdeg.unsigned_abs()).unwrap_or(0)) * 1.0e-3;
    if mdeg < 0 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec as List;

    fn elevations(beams: &Beams, rings: usize) -> List<f32> {
        beams.rings(rings).iter().map(|channel| beams.elevation_deg(*channel)).collect()
    }

    #[test]
    fn sixteen_of_many_rings_are_the_nearest() {
        // OS1-64: 45°, 0.714° apart; half of that is the farthest from a wanted elevation.
        let found = elevations(&Beams::even(64, (22_500, -22_500)), 16);
        assert_eq!(found.len(), 16);
        for (wanted, found) in (0_u8..).map(|ring| f32::from(ring) * 2.0 - 15.0).zip(&found) {
            assert!((wanted - found).abs() < 0.36, "{found} for {wanted}");
        }
        // OS2-128 sees 22.5°: sixteen even steps of them.
        let found = elevations(&Beams::even(128, (11_250, -11_250)), 16);
        assert!((found[0] + 11.25).abs() < 0.01 && (found[15] - 11.25).abs() < 0.01, "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
        // An OS1-16 is taken whole, and one of 32 steps of 1.45° gives one for each that is wanted.
        assert_eq!(elevations(&Beams::even(16, (15_000, -15_000)), 16).len(), 16);
        let found = elevations(&Beams::even(32, (22_500, -22_500)), 16);
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
        assert_eq!(elevations(&Beams::even(64, (22_500, -22_500)), 128).len(), 64);
    }

    /// For each kind: the two choices together have every beam from the lowest to the highest new one, and the new ones lie
    /// between those of the first.
    #[test]
    fn second_rings_lie_between_the_first() {
        for (channels, half_mdeg, new_min) in [
            (32, 22_500, 4),
            (64, 22_500, 16),
            (128, 22_500, 16),
            (32, 11_250, 14),
            (64, 11_250, 16),
            (64, 45_000, 4),
            (128, 45_000, 16),
        ] {
            let beams = Beams::even(channels, (half_mdeg, -half_mdeg));
            let (first, second) = (beams.rings(16), beams.second_rings());
            assert_eq!(second.len(), 16, "{channels} beams");
            let deg = |channel: &u8| beams.elevation_deg(*channel);
            assert!(second.windows(2).all(|pair| deg(&pair[0]) < deg(&pair[1])), "{channels} beams");
            let new: List<f32> = second.iter().filter(|channel| !first.contains(channel)).map(deg).collect();
            assert!(new.len() >= new_min, "{channels} beams: {new:?}");
            assert!(new[0] > deg(&first[0]) && new[new.len() - 1] < deg(&first[15]));
            let middle =
                (0..channels).filter(|channel| (new[0]..=new[new.len() - 1]).contains(&deg(channel)));
            for channel in middle {
                assert!(first.contains(&channel) || second.contains(&channel), "{}", deg(&channel));
            }
        }
        // Nothing new: a sensor of 16 beams, and one whose beams are all wanted for the first look.
        assert!(Beams::even(16, (15_000, -15_000)).second_rings().is_empty());
        assert!(Beams::even(18, (15_000, -15_000)).second_rings().is_empty());
    }

    #[test]
    fn shifts_are_whole_columns_of_azimuths() {
        let mut beams = Beams::even(4, (10_000, -10_000));
        beams.azimuth_mdeg[..4].copy_from_slice(&[3_164, 1_055, -1_055, -3_164]);
        assert_eq!([0, 1, 2, 3].map(|channel| beams.shift(channel)), [9, 3, -3, -9]);
        beams.columns_per_turn = 2_048;
        assert_eq!([0, 1, 2, 3].map(|channel| beams.shift(channel)), [18, 6, -6, -18]);
        assert_eq!(beams.fault(), None);
    }

    #[test]
    fn impossible_sensors_are_refused_with_a_reason() {
        let good = Beams::even(32, (22_500, -22_500));
        let faults = [
            Beams { channels: 0, ..good },
            Beams { columns_per_turn: 1_000, ..good },
            Beams { columns_per_packet: 0, ..good },
            Beams { azimuth_mdeg: core::array::from_fn(|channel| 1_000 * channel as i32), ..good },
            Beams { altitude_mdeg: [90_000; CHANNELS_MAX], ..good },
        ];
        assert_eq!(good.fault(), None);
        assert!(faults.iter().all(|beams| beams.fault().is_some()));
    }
}
