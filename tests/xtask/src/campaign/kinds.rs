//! The campaigns that there are. Each is a test, whose short slice CI runs too.

/// A test that takes its part of the campaign from the environment.
pub struct Kind {
    /// Name on the command line.
    pub name: &'static str,
    /// What a trial is.
    pub trial: &'static str,
    /// Package and target that hold the test.
    pub package: &'static str,
    /// `--lib`, or `--test` with the name of the file.
    pub target: &'static [&'static str],
    /// Path of the test.
    pub test: &'static str,
    /// Trials of one process: some seconds of work.
    pub block: u64,
    /// Trials of a whole campaign.
    pub trials: u64,
    /// Runtime and simulator make the trials, too, not only core and drivers.
    pub whole: bool,
}

const fn fuzz(name: &'static str, test: &'static str, block: u64, trials: u64) -> Kind {
    let target = &["--test", "fuzz_decoders"];
    let (trial, package) = ("damaged messages", "floorguard-tests");
    Kind { name, trial, package, target, test, block, trials, whole: false }
}

/// The campaign that needs the firmware.
pub const FIRMWARE_FAULTS: &str = "firmware-faults";

/// All campaigns.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "model",
        trial: "runs of 2,000 steps against a second model of the decision machine",
        package: "floorguard-tests",
        target: &["--test", "guard_second_model"],
        test: "fg_req_005_two_models_agree_on_every_random_step",
        block: 1_000,
        trials: 50_000,
        whole: false,
    },
    Kind {
        name: "flips",
        trial: "moments of a mission, at each of which every bit of the guard's state and of its copy is flipped",
        package: "floorguard-core",
        target: &["--lib"],
        test: "guard::tests::bit_flips::fg_req_008_no_flipped_bit_of_the_state_is_silently_unsafe",
        block: 25,
        trials: 2_000,
        whole: false,
    },
    Kind {
        name: "faults",
        trial: "runs of the whole robot, each with one fault of one class at one source in one phase",
        package: "floorguard-tests",
        target: &["--test", "fault_campaign"],
        test: "no_fault_of_the_matrix_makes_the_robot_miss_a_stop",
        block: 60,
        trials: 100_000,
        whole: true,
    },
    Kind {
        name: FIRMWARE_FAULTS,
        trial: "runs with a fault, the inputs of each played on the emulated Cortex-M7 too, with the host's fingerprint",
        package: "floorguard-tests",
        target: &["--test", "firmware_faults"],
        test: "the_emulated_board_answers_every_fault_as_the_host_does",
        block: 10,
        // A tape holds nothing of a fault in the computer: 1,040 of these are runs, and 945 of the first thousand.
        trials: 1_100,
        whole: true,
    },
    Kind {
        name: "claims",
        trial: "cleaning missions, three in four with slip, pushes, lost packets and power cuts",
        package: "floorguard-tests",
        target: &["--test", "cleaning_claims"],
        test: "claims_hold_under_slip_pushes_lost_packets_and_power_cuts",
        block: 20,
        trials: 1_000,
        whole: true,
    },
    Kind {
        name: "fuzz-runtime",
        trial: "worlds in which the whole robot runs under two to six faults at once",
        package: "floorguard-tests",
        target: &["--test", "fuzz_runtime"],
        test: "any_faults_at_once_leave_the_runtime_running",
        block: 50,
        trials: 100_000,
        whole: true,
    },
    fuzz("fuzz-velodyne", "fuzz_velodyne", 500_000, 100_000_000),
    fuzz("fuzz-position", "fuzz_position", 1_000_000, 100_000_000),
    fuzz("fuzz-s300", "fuzz_s300", 200_000, 100_000_000),
    fuzz("fuzz-slcan", "fuzz_slcan", 1_000_000, 100_000_000),
    fuzz("fuzz-microscan3", "fuzz_microscan3", 500_000, 100_000_000),
    // Twenty frames each.
    fuzz("fuzz-base", "fuzz_base", 100_000, 5_000_000),
    fuzz("fuzz-xsens", "fuzz_xsens", 200_000, 100_000_000),
    // The runtime reads these.
    Kind { whole: true, ..fuzz("fuzz-configuration", "fuzz_configuration", 200_000, 100_000_000) },
    Kind { whole: true, ..fuzz("fuzz-recording", "fuzz_recording", 20_000, 1_000_000) },
];

/// Campaigns that do not count trials of one kind.
const OTHERS: [&str; 4] = ["loops", "worst", "mutants-guard", "mutants-drivers"];

/// Whether there is such a campaign; if not, which ones there are.
#[cfg(test)]
pub fn exists(name: &str) -> Result<(), String> {
    if OTHERS.contains(&name) { Ok(()) } else { find(name).map(|_| ()) }
}

/// By its name, or the names that there are.
pub fn find(name: &str) -> Result<&'static Kind, String> {
    let names = || {
        let kinds = KINDS.iter().map(|kind| kind.name);
        kinds.chain(OTHERS).collect::<Vec<_>>().join(", ")
    };
    KINDS
        .iter()
        .find(|kind| kind.name == name)
        .ok_or_else(|| format!("no campaign `{name}`; there are: {}", names()))
}

#[cfg(test)]
mod tests {
    use super::KINDS;

    /// What is fuzzed in-process is fuzzed by libFuzzer, too, and is in the book.
    #[test]
    fn every_fuzzing_campaign_has_a_target_of_libfuzzer() {
        let root = crate::shell::root();
        let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap_or_default();
        let (manifest, book) = (read("fuzz/Cargo.toml"), read("docs/src/fuzzing.md"));
        for name in KINDS.iter().filter_map(|kind| kind.name.strip_prefix("fuzz-")) {
            let file = format!("fuzz_targets/{name}.rs");
            assert!(manifest.contains(&format!("path = \"{file}\"")), "{name} is not in fuzz/Cargo.toml");
            assert!(read(&format!("fuzz/{file}")).contains("fuzz_target!"), "{file} is no target");
            assert!(book.contains(&format!("| `{name}` |")), "{name} is not in the book");
        }
    }
}
