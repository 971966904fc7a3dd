//! Searches the inputs that cost the firmware the most, or measures those that were found: `cargo xtask campaign worst`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use floorguard_tests::worst::{Emulator, STAGES, compare, load, search, store};

/// What to do.
#[derive(Parser)]
struct Arguments {
    /// The linked image that plays tapes.
    #[arg(long)]
    image: PathBuf,
    /// The kept inputs.
    #[arg(long)]
    golden: PathBuf,
    /// Search this many scenes for each stage; without it the kept ones are measured again.
    #[arg(long)]
    search: Option<u64>,
    /// Seed of the search.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Replace the counts of the kept inputs.
    #[arg(long)]
    update: bool,
}

fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    let folder = tempfile::tempdir()?;
    let emulator = Emulator { image: arguments.image, tape: folder.path().join("worst.tape") };
    if let Some(trials) = arguments.search {
        for stage in STAGES {
            let mut all = load(&arguments.golden)?;
            let known = all.iter().position(|kept| kept.stage == stage).map(|at| all.remove(at));
            let found = search(stage, (arguments.seed, trials), known.as_ref(), &emulator)?;
            println!("{stage}: {} instructions at most in {} scenes", found.instructions, found.trials);
            all.push(found);
            all.sort_by(|a, b| a.stage.cmp(&b.stage));
            store(&arguments.golden, &all)?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let good = compare(&arguments.golden, &emulator, arguments.update)?;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
