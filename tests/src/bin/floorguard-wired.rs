//! Runs the firmware on the emulated board with the simulator on its wires: `cargo xtask firmware --wired`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use floorguard_tests::wired::{Options, Which, run, run_faults};

/// What to run.
#[derive(Parser)]
struct Arguments {
    /// The linked image.
    #[arg(long)]
    image: PathBuf,
    /// Scenario of the simulator.
    #[arg(long, default_value = "crossing")]
    scenario: String,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Seconds of the board's time.
    #[arg(long, default_value_t = 60)]
    duration: u32,
    /// Break the firmware on purpose instead, one fault after the other.
    #[arg(long, num_args = 0..=1, default_missing_value = "all")]
    faults: Option<Which>,
    /// The program `floorguard`, which reads the black box.
    #[arg(long, requires = "faults")]
    program: Option<PathBuf>,
    /// One object on standard output.
    #[arg(long)]
    json: bool,
}

fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    if let Some(which) = arguments.faults {
        let program = arguments.program.unwrap_or_else(|| PathBuf::from("floorguard"));
        let good = run_faults(&arguments.image, &program, which)?;
        return Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    let options = Options {
        image: arguments.image,
        scenario: arguments.scenario,
        seed: arguments.seed,
        duration_us: u64::from(arguments.duration) * 1_000_000,
    };
    let outcome = run(&options)?;
    if arguments.json {
        println!("{}", outcome.to_json());
    } else {
        println!("{outcome}");
    }
    Ok(if outcome.is_good() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
