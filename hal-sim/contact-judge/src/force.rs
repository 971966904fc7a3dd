//! How hard a contact is.
//!
//! People: the two-body model of ISO/TS 15066:2016, annex A (force = relative speed · √(stiffness · reduced mass)) with
//! the stiffness and effective mass of its table of body regions and the limits of its table of pressures and forces.
//! Objects have no limits; their classes are speeds.
//!
//! The figures are not compared with the text of the standard, which is not public. Stiffness and effective mass agree with an
//! implementation that others published, stiffness also with a published table; so do the limits of face, chest and thigh. Of
//! forearm and lower leg secondary sources differ (150 or 160 N, 130 or 180 N); those here are what the project has used from its
//! beginning. The classes compare runs with each other and prove no conformity.

use serde::Serialize;

use crate::scene::LimbName;

/// Classes of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceClass {
    /// A person: within the limit of lasting force. An object: slower than 0.05 m/s.
    Touch,
    /// A person: within the limit of a short impact. An object: slower than 0.25 m/s.
    Bump,
    /// Beyond both.
    Harm,
}

/// How hard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Force {
    /// Class.
    pub class: ForceClass,
    /// Estimate for people, newtons.
    pub newton: Option<f32>,
}

/// Stiffness of a part of the body, its effective mass, and its limits for lasting force and short impacts.
struct Limits {
    stiffness_n_per_m: f32,
    mass_kg: f32,
    lasting_n: f32,
    impact_n: f32,
}

const fn limits(limb: LimbName) -> Option<Limits> {
    let (stiffness_n_per_m, mass_kg, lasting_n, factor) = match limb {
        LimbName::LowerLeg => (60_000.0, 75.0, 130.0, 2.0),
        LimbName::Thigh => (50_000.0, 75.0, 220.0, 2.0),
        LimbName::Torso => (25_000.0, 40.0, 140.0, 2.0),
        LimbName::Arm => (40_000.0, 2.0, 160.0, 2.0),
        // No impact on the face is permitted: the limit of lasting force counts for both.
        LimbName::Head => (75_000.0, 4.4, 65.0, 1.0),
        LimbName::Carried => return None,
    };
    Some(Limits { stiffness_n_per_m, mass_kg, lasting_n, impact_n: lasting_n * factor })
}

/// Of a robot of this mass that closes in on a limb, or on an object, at this speed.
#[must_use]
pub fn force(limb: Option<LimbName>, closing_mps: f32, robot_kg: f32) -> Force {
    let speed_mps = closing_mps.max(0.0);
    let Some(limits) = limb.and_then(limits) else {
        let class = match speed_mps {
            slow if slow < 0.05 => ForceClass::Touch,
            slow if slow < 0.25 => ForceClass::Bump,
            _ => ForceClass::Harm,
        };
        return Force { class, newton: None };
    };
    let reduced_kg = 1.0 / (1.0 / robot_kg.max(1.0) + 1.0 / limits.mass_kg);
    let newton = speed_mps * libm::sqrtf(limits.stiffness_n_per_m * reduced_kg);
    let class = match newton {
        small if small <= limits.lasting_n => ForceClass::Touch,
        small if small <= limits.impact_n => ForceClass::Bump,
        _ => ForceClass::Harm,
    };
    Force { class, newton: Some(newton) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_by_hand() {
        // 300 kg and 75 kg: reduced mass 60 kg; √(60,000 · 60) = 1,897 N·s/m.
        let leg = force(Some(LimbName::LowerLeg), 0.1, 300.0);
        assert!(leg.newton.is_some_and(|newton| (newton - 189.7).abs() < 0.1), "{leg:?}");
        assert_eq!(leg.class, ForceClass::Bump);
        assert_eq!(force(Some(LimbName::LowerLeg), 0.06, 300.0).class, ForceClass::Touch);
        assert_eq!(force(Some(LimbName::LowerLeg), 0.3, 300.0).class, ForceClass::Harm);
        assert_eq!(force(Some(LimbName::Head), 0.3, 300.0).class, ForceClass::Harm);
        assert_eq!(force(None, 0.2, 300.0), Force { class: ForceClass::Bump, newton: None });
        assert_eq!(
            force(Some(LimbName::Carried), 0.3, 300.0),
            Force { class: ForceClass::Harm, newton: None }
        );
        // Who moves away is only touched.
        assert_eq!(force(None, -1.0, 300.0).class, ForceClass::Touch);
    }
}
