//! What the azimuths and stamps of packets must be, and what is missing between them.

use super::decode_error::DecodeError;
use super::packet::{BLOCKS, BlockTurn, GAP_MAX_CDEG, Packet};

/// A longer silence is a restart, not a number of lost packets.
const LOST_MAX: u32 = 750;

/// The head turns, neither too slow nor too fast, in every block; blocks of a dual return come in pairs.
pub(super) fn check_rotation(packet: &Packet<'_>, turns: &[BlockTurn; BLOCKS]) -> Result<(), DecodeError> {
    if packet.is_dual() {
        let (pairs, _) = turns.as_chunks::<2>();
        for [first, second] in pairs {
            if let (Some(first_cdeg), Some(second_cdeg)) = (first.azimuth_cdeg, second.azimuth_cdeg)
                && first_cdeg != second_cdeg
            {
                return Err(DecodeError::NoPairs { first_cdeg, second_cdeg });
            }
        }
    }
    let mut known = turns.iter().filter(|turn| turn.azimuth_cdeg.is_some());
    // Two jumps in a packet are one block with a wrong azimuth, or a field of view narrower than a packet.
    let jumps = known.clone().filter(|turn| turn.skipped_cdeg > 0).count();
    if jumps > 1
        && let Some(first) = known.clone().find(|turn| turn.skipped_cdeg > 0)
    {
        return Err(DecodeError::Rotation { gap_cdeg: first.skipped_cdeg.saturating_add(first.gap_cdeg) });
    }
    match known.find(|turn| !(1..=GAP_MAX_CDEG).contains(&turn.gap_cdeg)) {
        Some(BlockTurn { gap_cdeg, .. }) => Err(DecodeError::Rotation { gap_cdeg: *gap_cdeg }),
        None => Ok(()),
    }
}

/// A block (pair) that stands alone on its side of a jump may have a wrong azimuth as well as a closed sector beside it.
pub(super) fn leave_out_alone(turns: &mut [BlockTurn; BLOCKS], is_dual: bool) {
    let step = if is_dual { 2 } else { 1 };
    let Some(jump) = turns.iter().position(|turn| turn.skipped_cdeg > 0) else { return };
    let known = |from: usize, until: usize| {
        turns.iter().take(until).skip(from).filter(|turn| turn.azimuth_cdeg.is_some()).count() / step
    };
    let alone = if known(jump, BLOCKS) == 1 {
        Some((jump, BLOCKS))
    } else if known(0, jump) == 1 {
        Some((0, jump))
    } else {
        None
    };
    if let Some((from, until)) = alone {
        turns.iter_mut().take(until).skip(from).for_each(|turn| turn.azimuth_cdeg = None);
        turns.iter_mut().for_each(|turn| turn.skipped_cdeg = 0);
    }
}

pub(super) fn lost_packets(step_us: Option<u32>, period_us: u32) -> u16 {
    let periods = step_us.map_or(1, |step| step.saturating_add(period_us / 2) / period_us.max(1));
    let lost = periods.saturating_sub(1);
    if lost > LOST_MAX { 0 } else { u16::try_from(lost).unwrap_or(0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_packets_are_the_nearest_number_of_periods() {
        assert_eq!(lost_packets(None, 1_327), 0);
        assert_eq!(lost_packets(Some(1_327), 1_327), 0);
        assert_eq!(lost_packets(Some(1_990), 1_327), 0, "less than half a period late");
        assert_eq!(lost_packets(Some(3_450), 1_327), 2, "2.6 periods");
        assert_eq!(lost_packets(Some(1_000 * (LOST_MAX + 1)), 1_000), LOST_MAX as u16);
        assert_eq!(lost_packets(Some(1_000 * (LOST_MAX + 2)), 1_000), 0, "a clock that was set, no gap");
    }
}
