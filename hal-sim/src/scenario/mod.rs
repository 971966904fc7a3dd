//! Scenarios: a scene, people and a route, from a text file.

mod built_in;
mod encounter;
mod file;

pub use file::{PersonFile, RecordedFile, RouteFile, Scenario, ScenarioError, StartFile};
