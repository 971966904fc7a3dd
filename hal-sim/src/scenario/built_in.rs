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
}
