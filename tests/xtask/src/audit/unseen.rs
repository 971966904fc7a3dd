//! Why no counted test reached some loops: by the file that holds them.

/// Where files begin, and which tests are to reach what no count has reached there. `cargo xtask campaign loops --trials 2` counts
/// most of them, `--trials 3` all; some loops are for what seldom is: a full list, a map that overflows.
const REASONS: &[(&str, &str)] = &[
    ("core-nostd/src/cleaning/", "tests/tests/cleaning_missions.rs"),
    ("core-nostd/src/floor/", "tests/tests/floor_dirt.rs, floor_objects.rs"),
    ("core-nostd/src/legs/", "tests/tests/legs_leigh.rs"),
    ("core-nostd/src/maps/", "tests/tests/floor_dirt.rs, environment_learning.rs"),
    ("core-nostd/src/motion/", "tests/tests/motion_corridor.rs, motion_fabu.rs"),
    ("core-nostd/src/people/", "tests/tests/people_fabu.rs, robot_in_virtual_time.rs"),
    ("core-nostd/src/sensing/", "tests/tests/rgbd_people.rs"),
    ("drivers/src/velodyne/sweep_builder.rs", "tests/tests/velodyne_captures.rs"),
];

/// The tests that reach what the counted tests did not.
pub fn reason(file: &str) -> Option<&'static str> {
    REASONS.iter().find(|(beginning, _)| file.starts_with(beginning)).map(|(_, tests)| *tests)
}

#[cfg(test)]
mod tests {
    use super::REASONS;

    #[test]
    fn the_named_tests_exist() {
        for name in REASONS.iter().flat_map(|(_, tests)| tests.split(", ")) {
            let name = name.rsplit('/').next().unwrap_or(name);
            assert!(crate::shell::root().join("tests/tests").join(name).is_file(), "{name}");
        }
    }
}
