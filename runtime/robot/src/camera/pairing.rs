//! Which colour picture belongs to which depth picture: those that were taken at about the same moment.

use floorguard_types::geometry::Pose2;
use floorguard_types::time::{Age, Stamp};

/// Pictures within this belong together, microseconds: between them the robot drives half a cell of the map of dirt at
/// 1 m/s, and two cameras of 30 Hz that know nothing of each other are 17 ms apart at most.
const TOGETHER_US: u64 = 25_000;

/// The newest of both streams that still wait for each other.
#[derive(Debug, Default)]
pub struct Pairing {
    depth: Option<(Stamp, Pose2)>,
    colour: Option<(Stamp, Vec<u8>)>,
    /// Colour pictures to which no depth picture came.
    pub alone: u32,
}

/// Colour that belongs to the newest depth picture.
#[derive(Debug, PartialEq)]
pub struct Pair {
    /// When the colour picture was taken.
    pub stamp: Stamp,
    /// Where the robot was at the depth picture.
    pub robot: Pose2,
    /// Red, green, blue.
    pub rgb: Vec<u8>,
}

impl Pairing {
    /// A depth picture, and where the robot was.
    pub fn depth(&mut self, stamp: Stamp, robot: Pose2) -> Option<Pair> {
        self.depth = Some((stamp, robot));
        self.pair()
    }

    /// A colour picture.
    pub fn colour(&mut self, stamp: Stamp, rgb: Vec<u8>) -> Option<Pair> {
        self.alone = self.alone.saturating_add(u32::from(self.colour.is_some()));
        self.colour = Some((stamp, rgb));
        self.pair()
    }

    fn pair(&mut self) -> Option<Pair> {
        let (depth, robot) = self.depth?;
        let (stamp, _) = self.colour.as_ref()?;
        let (apart_us, is_colour_older) = match stamp.age(depth) {
            Age::Past(age_us) => (age_us, true),
            Age::Future(early_us) => (early_us, false),
        };
        if apart_us <= TOGETHER_US {
            self.depth = None;
            return self.colour.take().map(|(stamp, rgb)| Pair { stamp, robot, rgb });
        }
        if is_colour_older {
            // No later depth picture is nearer.
            self.colour = None;
            self.alone = self.alone.saturating_add(1);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Stamp {
        Stamp::from_micros(1_000 * ms)
    }

    #[test]
    fn the_same_moment_belongs_together_in_either_order() {
        let mut pairing = Pairing::default();
        let robot = Pose2::new(1.0, 2.0, 0.0);
        assert_eq!(pairing.depth(at(100), robot), None);
        assert_eq!(pairing.colour(at(125), vec![1]), Some(Pair { stamp: at(125), robot, rgb: vec![1] }));
        assert_eq!(pairing.colour(at(140), vec![2]), None, "the depth picture is taken");
        assert_eq!(pairing.depth(at(133), robot), Some(Pair { stamp: at(140), robot, rgb: vec![2] }));
        assert_eq!(pairing.alone, 0);
    }

    #[test]
    fn what_is_apart_is_not_paired() {
        let mut pairing = Pairing::default();
        assert_eq!(pairing.colour(at(100), vec![1]), None);
        assert_eq!((pairing.depth(at(126), Pose2::default()), pairing.alone), (None, 1), "too old");
        assert_eq!((pairing.colour(at(152), vec![2]), pairing.alone), (None, 1), "too new, but it may wait");
        assert_eq!((pairing.colour(at(185), vec![3]), pairing.alone), (None, 2), "it waited in vain");
        assert!(pairing.depth(at(200), Pose2::default()).is_some());
    }
}
