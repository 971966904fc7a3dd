//! What must be free around the robot, by the way it drives.

use floorguard_types::motion::{Footprint, Gear};

/// Two outlines in the robot's frame. A guard wants more room before a robot that goes ahead or turns than behind one that backs.
#[derive(Clone, Debug, PartialEq)]
pub struct GearOutlines {
    /// Ahead and on the spot.
    pub ahead: Footprint,
    /// Backwards.
    pub back: Footprint,
}

impl GearOutlines {
    /// The same outline whichever way it drives.
    #[must_use]
    pub fn alike(outline: Footprint) -> Self {
        Self { ahead: outline.clone(), back: outline }
    }

    /// What a gear needs.
    #[must_use]
    pub const fn of(&self, gear: Gear) -> &Footprint {
        match gear {
            Gear::Ahead | Gear::Spin => &self.ahead,
            Gear::Back => &self.back,
        }
    }
}
