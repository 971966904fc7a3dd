//! The scenarios that come with the simulator.

use super::{Scenario, ScenarioError};

const ALL: [(&str, &str); 8] = [
    ("supermarket", include_str!("../../scenarios/supermarket.toml")),
    ("busy-supermarket", include_str!("../../scenarios/busy-supermarket.toml")),
    ("corridor", include_str!("../../scenarios/corridor.toml")),
    ("airport", include_str!("../../scenarios/airport.toml")),
    ("warehouse", include_str!("../../scenarios/warehouse.toml")),
    ("crossing", include_str!("../../scenarios/crossing.toml")),
    ("encounter", include_str!("../../scenarios/encounter.toml")),
    ("empty", include_str!("../../scenarios/empty.toml")),
];

impl Scenario {
    /// Names of the built-in scenarios.
    pub fn names() -> impl Iterator<Item = &'static str> {
        ALL.iter().map(|(name, _)| *name)
    }

    /// A built-in scenario.
    ///
    /// # Errors
    /// None has this name.
    pub fn named(name: &str) -> Result<Self, ScenarioError> {
        let found = ALL.iter().find(|(known, _)| *known == name);
        let (_, text) = found.ok_or_else(|| {
            ScenarioError::Unknown(name.to_owned(), Self::names().collect::<Vec<_>>().join(", "))
        })?;
        Self::from_toml(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_scenarios_are_readable_with_routes() {
        for name in Scenario::names() {
            let scenario = Scenario::named(name).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(!scenario.route.waypoints_m.is_empty(), "{name}");
        }
        assert!(matches!(Scenario::named("moon"), Err(ScenarioError::Unknown(..))));
    }

    /// A route through a shelf holds the robot there for ever, and rightly. The furniture of these scenarios stands along the axes.
    #[test]
    fn no_route_leads_through_furniture() {
        /// Half the width of the robot's body and a margin, metres.
        const BESIDE_M: f32 = 0.6;
        for name in Scenario::names() {
            let scenario = Scenario::named(name).unwrap_or_else(|error| panic!("{name}: {error}"));
            let stops = &scenario.route.waypoints_m;
            let again = stops.first().filter(|_| scenario.route.repeat);
            let places: Vec<[f32; 2]> =
                std::iter::once(&scenario.start.at_m).chain(stops).chain(again).copied().collect();
            for (from, to) in places.iter().zip(places.iter().skip(1)) {
                for step in 0..=200_u16 {
                    let share = f32::from(step) / 200.0;
                    let place = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
                    let gap_m = scenario.scene.furniture.iter().map(|item| {
                        let [x_m, y_m] = [0, 1]
                            .map(|axis| ((place[axis] - item.at_m[axis]).abs() - 0.5 * item.size_m[axis]).max(0.0));
                        x_m.hypot(y_m)
                    });
                    let gap_m = gap_m.fold(f32::INFINITY, f32::min);
                    assert!(gap_m > BESIDE_M, "{name}: {gap_m} m at {place:?}");
                }
            }
        }
    }
}
