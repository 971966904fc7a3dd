//! What a gap is called, as `floorguard check` prints it and `accept_unseen` accepts it.

use std::fmt;

use super::area::Region;

/// Heights that are written are rounded, metres.
const SAME_HEIGHT_M: f32 = 0.005;

/// What no sensor sees, heights in metres above the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unseen {
    /// Upright objects that are lower.
    Below(f32),
    /// Upright objects that are lower, where they come in from aside nearer than the robot needs to stop.
    SteppingIn(f32),
    /// Boards and bars whose lower edge lies between the two.
    Hanging([f32; 2]),
}

/// Where no sensor sees what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Where.
    pub region: Region,
    /// What.
    pub unseen: Unseen,
}

impl fmt::Display for Gap {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let region = self.region.name();
        match self.unseen {
            Unseen::Below(height_m) => write!(out, "{region} below {height_m:.2} m"),
            Unseen::SteppingIn(height_m) => write!(out, "{region} stepping in below {height_m:.2} m"),
            Unseen::Hanging([from_m, to_m]) => write!(out, "{region} hanging {from_m:.2} to {to_m:.2} m"),
        }
    }
}

impl Gap {
    /// Reads a name; `None`: it names no gap.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (name, rest) = words.split_first()?;
        let region = Region::ALL.into_iter().find(|region| region.name() == *name)?;
        let number = |word: &str| word.parse::<f32>().ok().filter(|metres| (0.0..=3.0).contains(metres));
        let unseen = match rest {
            ["below", height, "m"] => Unseen::Below(number(height)?),
            ["stepping", "in", "below", height, "m"] => Unseen::SteppingIn(number(height)?),
            ["hanging", from, "to", to, "m"] => Unseen::Hanging([number(from)?, number(to)?]),
            _ => return None,
        };
        Some(Self { region, unseen })
    }

    /// The two are one gap, with the same heights.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        self.difference_m(other).is_some_and(|metres| metres < SAME_HEIGHT_M)
    }

    /// How much the heights of the two differ, metres; `None`: they differ in more than their heights.
    #[must_use]
    pub fn difference_m(&self, other: &Self) -> Option<f32> {
        match (self.unseen, other.unseen) {
            _ if self.region != other.region => None,
            (Unseen::Below(a), Unseen::Below(b)) | (Unseen::SteppingIn(a), Unseen::SteppingIn(b)) => {
                Some((a - b).abs())
            }
            (Unseen::Hanging([a, b]), Unseen::Hanging([c, d])) => Some((a - c).abs() + (b - d).abs()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fg_req_062_printed_names_are_read_again() {
        for region in Region::ALL {
            for unseen in [Unseen::Below(0.16), Unseen::SteppingIn(0.60), Unseen::Hanging([0.10, 1.40])] {
                let gap = Gap { region, unseen };
                let read = Gap::parse(&gap.to_string());
                assert!(read.is_some_and(|read| read.is_same(&gap)), "{gap}");
                assert_eq!(Gap::parse(region.name()), None, "a region as a whole would hide too much");
            }
        }
        for bad in ["", "behind", "rear below", "rear below 15 cm", "rear below -1 m", "rear hanging 0.1 m"] {
            assert_eq!(Gap::parse(bad), None, "{bad}");
        }
        let gap = |unseen| Gap { region: Region::Rear, unseen };
        assert!(!gap(Unseen::Below(0.12)).is_same(&gap(Unseen::Below(0.16))), "lower");
        assert!(!gap(Unseen::Below(0.16)).is_same(&gap(Unseen::SteppingIn(0.16))), "another kind");
    }
}
