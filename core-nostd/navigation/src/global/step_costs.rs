//! What a step into a cell costs: 3 · cost + 50 (ROS package `global_planner`: neutral cost 50, cost factor 3).

use floorguard_types::number::truncating_u16;

use crate::costmap::Costs;

/// Costs of steps by the cost of the cell that is entered; 0 is impassable.
#[derive(Clone, Debug)]
pub struct StepCosts {
    straight: [u16; 256],
    diagonal: [u16; 256],
}

impl StepCosts {
    /// Cost of a step over free floor.
    pub const NEUTRAL: u32 = 50;
    /// The same diagonally.
    pub const NEUTRAL_DIAGONAL: u32 = Self::NEUTRAL * 181 / 128;

    /// From [`Costs::INSCRIBED`] on nothing is passable; unknown floor only where allowed, and then like free floor.
    #[must_use]
    pub fn new(allow_unknown: bool) -> Self {
        let mut straight = [0; 256];
        for (cost, step) in straight.iter_mut().enumerate().take(usize::from(Costs::INSCRIBED)) {
            *step = truncating_u16(cost).saturating_mul(3).saturating_add(truncating_u16(Self::NEUTRAL));
        }
        if let Some(unknown) = straight.last_mut().filter(|_| allow_unknown) {
            *unknown = truncating_u16(Self::NEUTRAL);
        }
        // √2 as 181/128, as good as 0.01 %.
        let diagonal = straight.map(|step| truncating_u16(u32::from(step).saturating_mul(181) / 128));
        Self { straight, diagonal }
    }

    /// Cost of a step along a row or column; 0 is impassable.
    #[inline]
    #[must_use]
    pub fn straight(&self, cost: u8) -> u32 {
        u32::from(self.straight.get(usize::from(cost)).copied().unwrap_or(0))
    }

    /// Cost of a step across a corner; 0 is impassable.
    #[inline]
    #[must_use]
    pub fn diagonal(&self, cost: u8) -> u32 {
        u32::from(self.diagonal.get(usize::from(cost)).copied().unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_the_published_ones() {
        let (careful, bold) = (StepCosts::new(false), StepCosts::new(true));
        assert_eq!((careful.straight(0), careful.straight(252), careful.straight(253)), (50, 806, 0));
        assert_eq!((careful.straight(255), bold.straight(255), bold.straight(254)), (0, 50, 0));
        assert_eq!((careful.diagonal(0), careful.diagonal(252)), (70, 1_139));
    }
}
