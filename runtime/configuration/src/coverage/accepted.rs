//! Gaps that a file accepts by name, and what is wrong with its list.

use std::fmt;

use super::analysis::Coverage;
use super::gap::Gap;
use super::limits::GapSpeed;
use crate::reader::Reader;

/// Speeds at which a gap can be accepted, m/s.
const SLOWEST_MPS: f32 = 0.05;
const FASTEST_MPS: f32 = 2.0;

/// A gap that a file accepts, as it is written there.
pub type AcceptedGap = Gap;

/// Why a robot is refused: its sensors and its list of accepted gaps do not agree.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// A gap that is not accepted; beside it what the file accepts of its kind there.
    NotAccepted {
        /// The gap.
        gap: Gap,
        /// What is accepted instead.
        accepted: Option<Gap>,
    },
    /// A name that accepts what the sensors see.
    Superfluous(Gap),
}

impl fmt::Display for Refusal {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAccepted { gap, accepted: None } => write!(
                out,
                "no sensor sees \"{gap}\"; add or turn a sensor, or write \"{gap}\" into `accept_unseen` of [guard]: the body touches it"
            ),
            Self::NotAccepted { gap, accepted: Some(accepted) } => write!(
                out,
                "no sensor sees \"{gap}\", and `accept_unseen` of [guard] has \"{accepted}\"; mount the sensors as they were, or \
                 write \"{gap}\" instead"
            ),
            Self::Superfluous(gap) => write!(
                out,
                "`accept_unseen` of [guard] has \"{gap}\", and the sensors see that; leave it out, so that its loss is noticed"
            ),
        }
    }
}

impl Coverage {
    /// What is not accepted, and what is accepted without need. Empty: sensors and list agree (FG-REQ-062).
    #[must_use]
    pub fn refusals(&self, accepted: &[AcceptedGap]) -> Vec<Refusal> {
        let is_accepted = |gap: &Gap| accepted.iter().any(|accepted| accepted.is_same(gap));
        let gaps = || self.gaps.iter().map(|found| found.gap);
        let is_found = |gap: &Gap| gaps().any(|found| found.is_same(gap));
        let alike = |gap: &Gap| {
            let unused = accepted.iter().filter(|accepted| !is_found(accepted));
            let near = unused.filter_map(|accepted| Some((accepted.difference_m(gap)?, accepted)));
            near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, accepted)| accepted)
        };
        let missing: Vec<Refusal> = gaps()
            .filter(|gap| !is_accepted(gap))
            .map(|gap| Refusal::NotAccepted { gap, accepted: alike(&gap).copied() })
            .collect();
        let is_named = |gap: &Gap| {
            missing.iter().any(|refusal| matches!(refusal, Refusal::NotAccepted { accepted: Some(other), .. } if other == gap))
        };
        let superfluous = accepted.iter().filter(|gap| !is_found(gap) && !is_named(gap));
        let superfluous: Vec<Refusal> = superfluous.map(|gap| Refusal::Superfluous(*gap)).collect();
        [missing, superfluous].concat()
    }
}

/// What a file accepts: every gap, and those of them that are accepted up to a speed.
#[derive(Default)]
pub(crate) struct Accepted {
    pub(crate) gaps: Vec<AcceptedGap>,
    pub(crate) speeds: Vec<GapSpeed>,
}

/// A name with or without a speed behind it, m/s.
fn parse(text: &str) -> Option<(Gap, Option<f32>)> {
    let Some((name, speed)) = text.split_once(" at ") else { return Some((Gap::parse(text)?, None)) };
    let number = speed.strip_suffix(" m/s")?.parse::<f32>().ok();
    Some((Gap::parse(name)?, Some(number.filter(|mps| (SLOWEST_MPS..=FASTEST_MPS).contains(mps))?)))
}

/// Reads `accept_unseen`: what names no gap is refused, and what stands there twice.
pub(crate) fn read_accepted(section: &Reader<'_>) -> Accepted {
    let mut accepted = Accepted::default();
    for (text, span) in section.texts("accept_unseen", "[\"rear-left below 0.16 m\"]") {
        match parse(text) {
            Some((gap, _)) if accepted.gaps.iter().any(|known| known.is_same(&gap)) => section.refuse(
                &span,
                format!("[guard]: `accept_unseen` has \"{text}\" twice"),
                "leave one of the two out",
            ),
            Some((gap, speed)) => {
                accepted.gaps.push(gap);
                accepted.speeds.extend(speed.map(|touched_mps| GapSpeed { gap, touched_mps }));
            }
            None => section.refuse(
                &span,
                format!("[guard]: `accept_unseen`: \"{text}\" is not the name of a gap"),
                "write it as `floorguard check` prints it, for example \"rear-left below 0.16 m\", \"rear stepping in below 0.60 m\" \
                 or \"front hanging 0.80 to 1.40 m\", and behind it \" at 0.30 m/s\" (0.05 to 2) where the robot is to be slower",
            ),
        }
    }
    accepted
}
