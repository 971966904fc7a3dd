//! Families of worlds.

use floorguard_types::random::Pcg32;

use super::draft::Draft;
use super::{motion, people, things};
use crate::scenario::Scenario;

/// What a world is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HazardFamily {
    /// Objects of 3 cm to 2 m anywhere along a way with turns.
    Scatter,
    /// Boards at 0.25 to 0.85 m across the way.
    Overhang,
    /// Boxes of 3 to 20 cm on the way.
    Low,
    /// Pallet trucks whose tines lie on the way.
    Forks,
    /// Panes of glass and mirrors across the way.
    Glass,
    /// Aisles of 1.0 to 1.6 m with a corner.
    Aisle,
    /// Boxes beside the rear of a robot that turns.
    Tail,
    /// Forward, spin and reverse by hand among objects.
    Manoeuvres,
    /// A loading dock ahead or beside the way.
    Edge,
    /// Ramps from any side.
    Ramp,
    /// Rails and posts of 2 to 4 cm.
    Thin,
    /// People who stand, crouch, lie, reach or sit beside the way and on it.
    Standing,
    /// People who step out from behind shelves.
    StepOut,
    /// People who cross the way without looking, among objects.
    Crossing,
    /// Sensors that are not where the robot's file says, among objects.
    Misplaced,
}

impl HazardFamily {
    /// All, in the order in which a campaign plays them.
    pub const ALL: [Self; 15] = [
        Self::Scatter,
        Self::Overhang,
        Self::Low,
        Self::Forks,
        Self::Glass,
        Self::Aisle,
        Self::Tail,
        Self::Manoeuvres,
        Self::Edge,
        Self::Ramp,
        Self::Thin,
        Self::Standing,
        Self::StepOut,
        Self::Crossing,
        Self::Misplaced,
    ];

    /// For reports and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scatter => "scatter",
            Self::Overhang => "overhang",
            Self::Low => "low",
            Self::Forks => "forks",
            Self::Glass => "glass",
            Self::Aisle => "aisle",
            Self::Tail => "tail",
            Self::Manoeuvres => "manoeuvres",
            Self::Edge => "edge",
            Self::Ramp => "ramp",
            Self::Thin => "thin",
            Self::Standing => "standing",
            Self::StepOut => "step-out",
            Self::Crossing => "crossing",
            Self::Misplaced => "misplaced",
        }
    }
}

/// A world that hurts.
#[derive(Clone, Debug)]
pub struct Hazard {
    /// What it is about.
    pub family: HazardFamily,
    /// The world.
    pub scenario: Scenario,
}

impl Hazard {
    /// World number `trial` of a seed: families take turns.
    #[must_use]
    pub fn drawn(seed: u64, trial: u64) -> Self {
        let families = HazardFamily::ALL;
        let family = families[(trial % families.len() as u64) as usize];
        let mut random = Pcg32::new(seed ^ trial.wrapping_mul(0x9e37_79b9_7f4a_7c15), 77);
        let mut draft = Draft::new(family.name(), &mut random);
        match family {
            HazardFamily::Scatter => things::scatter(&mut draft),
            HazardFamily::Overhang => things::overhang(&mut draft),
            HazardFamily::Low => things::low(&mut draft),
            HazardFamily::Forks => things::forks(&mut draft),
            HazardFamily::Glass => things::glass(&mut draft),
            HazardFamily::Edge => things::edge(&mut draft),
            HazardFamily::Ramp => things::ramp(&mut draft),
            HazardFamily::Thin => things::thin(&mut draft),
            HazardFamily::Aisle => motion::aisle(&mut draft),
            HazardFamily::Tail => motion::tail(&mut draft),
            HazardFamily::Manoeuvres => motion::manoeuvres(&mut draft),
            HazardFamily::Misplaced => motion::misplaced(&mut draft),
            HazardFamily::Standing => people::standing(&mut draft),
            HazardFamily::StepOut => people::step_out(&mut draft),
            HazardFamily::Crossing => people::crossing(&mut draft),
        }
        Self { family, scenario: draft.scenario }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::RobotParameters;
    use crate::simulation::Simulation;

    fn worlds() -> impl Iterator<Item = Hazard> {
        (0..10 * HazardFamily::ALL.len() as u64).map(|trial| Hazard::drawn(3, trial))
    }

    #[test]
    fn world_is_seeded_and_round_trips() {
        for (trial, hazard) in worlds().enumerate() {
            let again = Hazard::drawn(3, trial as u64);
            let text = hazard.scenario.to_toml();
            assert_eq!(text, again.scenario.to_toml(), "{trial}");
            let read = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{trial}: {error}\n{text}"));
            assert_eq!(read.to_toml(), text, "{trial}");
        }
        assert_ne!(Hazard::drawn(3, 0).scenario.to_toml(), Hazard::drawn(4, 0).scenario.to_toml());
    }

    /// The robot begins free, and has somewhere to go.
    #[test]
    fn nothing_stands_in_the_robot_at_the_start() {
        for (trial, hazard) in worlds().enumerate() {
            let scenario = &hazard.scenario;
            let simulation = Simulation::new(scenario, 1).unwrap();
            for prism in &RobotParameters::default().body {
                let [low, high] = [prism.outline_m[0], prism.outline_m[2]];
                let half = [0, 1].map(|axis| (high[axis] - low[axis]) / 2.0);
                let middle = [0, 1].map(|axis| (high[axis] + low[axis]) / 2.0);
                let z = (prism.height_m[0] + prism.height_m[1]) / 2.0;
                let strip = parry3d::shape::Cuboid::new(parry3d::math::Vector::new(
                    half[0],
                    half[1],
                    (prism.height_m[1] - prism.height_m[0]) / 2.0,
                ));
                let at = parry3d::math::Vector::new(middle[0], middle[1], z);
                let pose = parry3d::math::Pose::from_translation(at);
                assert!(!simulation.scene().touches(&pose, &strip), "{trial} {}", hazard.family.name());
            }
            assert!(!scenario.manoeuvre.is_empty() || !scenario.route.waypoints_m.is_empty(), "{trial}");
        }
    }
}
