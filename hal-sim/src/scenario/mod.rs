//! Scenarios: a scene, people and a route, from a text file.

mod built_in;
mod encounter;
mod file;

pub use file::{
    ManoeuvreFile, MisplacedFile, PersonFile, RecordedFile, RouteFile, RunawayFile, Scenario, ScenarioError,
    StartFile, TurningGyroscopeFile,
};
