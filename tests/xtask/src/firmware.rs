//! `cargo xtask firmware`: the robot's tasks on the emulated Cortex-M7, fed from a tape that the host recorded.
//!
//! Equal bytes in must give equal outputs: people, decisions and drive frames have the same fingerprint on both
//! machines, or the command fails. What each kind of work costs in instructions is compared with a golden file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::firmware_replay::{self, check_length};
use crate::image_size::{Size, measure};
use crate::machine::TARGET;
use crate::{program, setup, shell, worst};
use embedded_audit::facts::facts;

/// The image that plays tapes.
const TAPE_IMAGE: &str = "floorguard-mps2-an500-tape";
/// The image that listens to devices.
const WIRED_IMAGE: &str = "floorguard-mps2-an500";
/// The board's PSRAM.
const TAPE_AT: u32 = 0x6000_0000;
/// Instruction counts may differ from the golden file by this share.
const GATE: f64 = 0.005;

/// Twelve people around the robot; what is counted of it, and how it is called.
const CROWD: &str = "tests/goldens/twelve_people.toml";
const CROWD_COUNTS: [&str; 4] = ["sweep", "stage-floor-clusters", "stage-features", "stage-track"];
const CROWD_SUFFIX: &str = "-12-people";
/// Bytes of flash, one of the chip's two banks: the other is left to an update; and of statics.
const FLASH_MAX: u64 = 1 << 20;
const RAM_MAX: u64 = 448 << 10;
/// Bytes of the black box across resets, outside of that memory: SRAM4 of the chip, PSRAM of the emulated board.
const KEPT_MAX: u64 = 64 << 10;
/// Bytes of statics that no DMA touches, outside of that memory, too: the chip's DTCM.
const COUPLED_MAX: u64 = 128 << 10;
/// Interrupt handlers of the images by level, the guard's executor first.
const BOARD_HANDLERS: &[&[&str]] = &[
    &["GUARD_EXECUTOR"],
    &[
        "ETHERNET",
        "UART0_RECEIVE",
        "UART0_TRANSMIT",
        "UART1_RECEIVE",
        "UART1_TRANSMIT",
        "UART2_RECEIVE",
        "UART2_TRANSMIT",
        "UART3_TRANSMIT",
        "UART4_RECEIVE",
        "UART4_TRANSMIT",
    ],
    &["DUAL_TIMER"],
    &["HardFault", "NonMaskableInt"],
];
const CHIP_HANDLERS: &[&[&str]] =
    &[&["CEC"], &["ETH", "USART2", "USART6", "FDCAN1_IT0", "FDCAN1_IT1"], &["TIM2"], &["HardFault_"]];

/// What to play.
#[derive(Args)]
pub struct Options {
    /// Scenario of the simulator.
    #[arg(long, default_value = "crossing")]
    scenario: String,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Simulated seconds: 8 from a tape, of which 16 MiB of memory hold about 16; 60 over wires.
    #[arg(long)]
    duration: Option<u32>,
    /// `mps2-an500`, which the emulator has, or `stm32h743`, which is only built, linked and measured.
    #[arg(long, default_value = "mps2-an500", value_parser = ["mps2-an500", "stm32h743"])]
    board: String,
    /// Over the board's devices instead of from a tape: UDP and serial lines, the simulator at their other end.
    #[arg(long)]
    wired: bool,
    /// Break the wired firmware on purpose, one fault after the other: each must stop the drives and tell its cause.
    /// `few`: one of each way to end.
    #[arg(long, conflicts_with_all = ["update", "wired"], num_args = 0..=1, default_missing_value = "all",
        value_parser = ["all", "few"])]
    faults: Option<String>,
    /// Play the packets of this lidar capture instead of a scenario: the robot stands, and its other devices are simulated.
    #[arg(long, value_name = "FILE.pcap.gz", conflicts_with_all = ["update", "wired", "faults", "scenario", "seed"])]
    replay: Option<PathBuf>,
    /// Write the counts to the golden file instead of comparing them.
    #[arg(long)]
    update: bool,
    /// One object on standard output.
    #[arg(long)]
    json: bool,
}

/// What one kind of work costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Cost {
    count: u64,
    mean: u64,
    max: u64,
}

/// What came of a run on the board.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Outcome {
    digest: String,
    /// By image; the run itself knows one.
    images: BTreeMap<String, Size>,
    instructions: BTreeMap<String, Cost>,
}

/// Runs the command; false when host and board differ, or a count leaves its gate.
pub fn run(options: &Options) -> Result<bool> {
    setup::need_target()?;
    if options.board == "stm32h743" {
        return link_for_the_chip(options.update);
    }
    setup::need_emulator()?;
    if options.wired || options.faults.is_some() {
        return wired(options);
    }
    let folder = target_folder()?;
    std::fs::create_dir_all(folder.join("firmware-run"))?;
    let tape = folder.join("firmware-run").join("input.tape");
    let hosted = match &options.replay {
        Some(capture) => firmware_replay::record(capture, options.duration, &tape)?,
        None => record((&options.scenario, options.seed, options.tape_seconds()), &tape)?,
    };
    let image = build(&folder, TAPE_IMAGE)?;
    let mut outcome = play(&image, &tape)?;
    let standard = options.replay.is_none()
        && (options.scenario.as_str(), options.seed, options.tape_seconds()) == ("crossing", 2, 8);
    let mut equal = outcome.digest == hosted;
    if standard {
        let crowd = record((CROWD, 2, 8), &tape)?;
        let played = play(&image, &tape)?;
        equal &= played.digest == crowd;
        let counted =
            played.instructions.into_iter().filter(|(name, _)| CROWD_COUNTS.contains(&name.as_str()));
        outcome.instructions.extend(counted.map(|(name, cost)| (name + CROWD_SUFFIX, cost)));
    }
    if !options.json {
        show(&outcome, &hosted);
    }
    if !equal {
        eprintln!("firmware: the board's outputs differ from the host's");
    }
    let within_gates =
        !standard || compare(&outcome, options.update)? & worst::check(&image, options.update)?;
    let verdict = Verdict { is_good: equal && within_gates, equal, within_gates, host_digest: hosted };
    if options.json {
        println!("{}", serde_json::to_string(&Judged { verdict: &verdict, outcome: &outcome })?);
    }
    Ok(verdict.is_good)
}

/// Whether the run is as it should be.
#[derive(Serialize)]
struct Verdict {
    #[serde(rename = "good")]
    is_good: bool,
    /// Host and board put out the same.
    equal: bool,
    /// No count and no size left its gate; only the standard run has gates.
    within_gates: bool,
    /// Fingerprint on the host.
    host_digest: String,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Judged<'a> {
    verdict: &'a Verdict,
    #[serde(flatten)]
    outcome: &'a Outcome,
}

/// Builds the image of the real chip and measures it; nothing here can run it.
fn link_for_the_chip(update: bool) -> Result<bool> {
    let target = target_folder()?.join("stm32h743");
    let mut build = shell::cargo();
    build.current_dir(shell::root().join("runtime/boards/stm32h743"));
    build.args(["build", "--quiet", "--release", "--target", TARGET]);
    build.env("CARGO_TARGET_DIR", &target);
    if !shell::succeeds(&mut build)? {
        bail!("the firmware of the stm32h743 does not build");
    }
    let size = measure(&target.join(TARGET).join("release/floorguard-stm32h743"), Some(CHIP_HANDLERS))?;
    println!("firmware: stm32h743 linked; it has never run on hardware");
    fits("stm32h743", size, update)
}

/// Shows and judges the size of an image: against the limits, and against the golden file, which `update` writes.
fn fits(image: &str, size: Size, update: bool) -> Result<bool> {
    let Size { flash_bytes, ram_bytes, stack_bytes, kept_bytes, coupled_bytes } = size;
    let stack_max = facts().firmware.as_ref().map_or(0, |firmware| firmware.stack_bytes);
    eprintln!(
        "firmware: {image}: {flash_bytes} of {FLASH_MAX} bytes of flash, {ram_bytes} of {RAM_MAX} of statics, \
         {stack_bytes} of {stack_max} of stack; elsewhere {kept_bytes} of {KEPT_MAX} that are kept across a reset, \
         {coupled_bytes} of {COUPLED_MAX} in tightly coupled memory"
    );
    let mut golden = golden()?;
    if update {
        golden.images.insert(image.to_owned(), size);
        write_golden(&golden)?;
    }
    // An image without a golden size has its limits only.
    let before = golden.images.get(image).copied().unwrap_or(Size {
        flash_bytes: FLASH_MAX,
        ram_bytes: RAM_MAX,
        stack_bytes: stack_max,
        kept_bytes: KEPT_MAX,
        coupled_bytes: COUPLED_MAX,
    });
    let judged = [
        ("flash", flash_bytes, FLASH_MAX, before.flash_bytes),
        ("statics", ram_bytes, RAM_MAX, before.ram_bytes),
        ("stack", stack_bytes, stack_max, before.stack_bytes),
        ("kept memory", kept_bytes, KEPT_MAX, before.kept_bytes),
        ("tightly coupled statics", coupled_bytes, COUPLED_MAX, before.coupled_bytes),
    ];
    let mut good = true;
    for (what, bytes, limit, golden) in judged {
        if bytes > limit {
            good = false;
            eprintln!("firmware: {image}: {bytes} bytes of {what}, {limit} are allowed");
        } else if bytes as f64 > golden as f64 * (1.0 + GATE) {
            good = false;
            eprintln!(
                "firmware: {image}: {bytes} bytes of {what}, golden {golden}; if that is meant: --update"
            );
        }
    }
    Ok(good)
}

impl Options {
    fn tape_seconds(&self) -> u32 {
        self.duration.unwrap_or(8)
    }
}

/// Runs the image that listens to devices, with the simulator on its wires; false when something was lost or late.
fn wired(options: &Options) -> Result<bool> {
    let image = build(&target_folder()?, WIRED_IMAGE)?;
    let small = fits("mps2-an500", measure(&image, Some(BOARD_HANDLERS))?, options.update)?;
    let mut play = program::command("floorguard-wired")?;
    play.arg("--image").arg(image).args([
        "--scenario",
        &options.scenario,
        "--seed",
        &options.seed.to_string(),
    ]);
    play.args(["--duration", &options.duration.unwrap_or(60).to_string()]);
    if let Some(which) = &options.faults {
        play.args(["--faults", which]).arg("--program").arg(program::built("floorguard")?);
    }
    if options.json {
        play.arg("--json");
    }
    Ok(shell::succeeds(&mut play)? && small)
}

/// Plays the scenario on the host; gives the fingerprint.
fn record((scenario, seed, seconds): (&str, u64, u32), tape: &Path) -> Result<String> {
    let mut simulate = program::command("floorguard")?;
    simulate.args(["simulate", "--json"]);
    simulate.args(["--scenario", scenario, "--seed", &seed.to_string()]);
    simulate.args(["--duration", &seconds.to_string(), "--tape"]).arg(tape);
    let printed =
        shell::output(&mut simulate).context("the hosted run failed; try `cargo run -- simulate`")?;
    check_length(tape)?;
    let verdict: serde_json::Value = serde_json::from_str(printed.trim())?;
    Ok(verdict["digest"].as_str().context("the verdict has no digest")?.to_owned())
}

/// The image that plays tapes, built.
pub fn tape_image() -> Result<PathBuf> {
    build(&target_folder()?, TAPE_IMAGE)
}

fn build(folder: &Path, image: &str) -> Result<PathBuf> {
    let mut build = shell::cargo();
    build.args(["build", "--quiet", "--package", "floorguard-mps2-an500", "--bin", image]);
    build.args(["--profile", "firmware", "--target", TARGET]);
    if !shell::succeeds(&mut build)? {
        bail!("the firmware does not build");
    }
    Ok(folder.join(TARGET).join("firmware").join(image))
}

/// Where cargo builds.
fn target_folder() -> Result<PathBuf> {
    let mut metadata = shell::cargo();
    metadata.args(["metadata", "--format-version", "1", "--no-deps", "--offline"]);
    let text = shell::output(&mut metadata).context("cargo metadata failed")?;
    let value: serde_json::Value = serde_json::from_str(&text)?;
    Ok(PathBuf::from(value["target_directory"].as_str().context("cargo names no target folder")?))
}

fn play(image: &Path, tape: &Path) -> Result<Outcome> {
    let mut emulator = Command::new("qemu-system-arm");
    emulator.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none", "-serial", "null"]);
    emulator.args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"]);
    let loader = format!("loader,file={},addr={TAPE_AT:#x},force-raw=on", tape.display());
    emulator.args(["-device", &loader, "-kernel"]).arg(image);
    let output = emulator.stdin(Stdio::null()).output().context("cannot start qemu-system-arm")?;
    // Semihosting writes to standard error.
    let text =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        bail!("the firmware failed: {}", text.trim());
    }
    let mut outcome = Outcome::default();
    for line in text.lines() {
        match line.split_whitespace().collect::<Vec<_>>().as_slice() {
            ["digest", digest] => outcome.digest = (*digest).to_owned(),
            ["instructions", name, "count", count, "mean", mean, "max", max] => {
                let cost = Cost { count: count.parse()?, mean: mean.parse()?, max: max.parse()? };
                outcome.instructions.insert((*name).to_owned(), cost);
            }
            _ => {}
        }
    }
    outcome.images.insert("mps2-an500-tape".to_owned(), measure(image, None)?);
    Ok(outcome)
}

fn show(outcome: &Outcome, hosted: &str) {
    println!("firmware: fingerprint on the host {hosted}, on the emulated Cortex-M7 {}", outcome.digest);
    println!("  {:22} {:>8} {:>12} {:>12} {:>12}", "instructions", "times", "mean", "most", "budget");
    let budgets = facts().firmware.as_ref().map(|firmware| &firmware.budgets);
    for (name, cost) in &outcome.instructions {
        let budget = budgets.and_then(|budgets| budgets.get(name)).copied();
        let verdict = match budget {
            Some(budget) if cost.max > budget => format!("{budget:>12}, over it"),
            Some(budget) => format!("{budget:>12}"),
            None => String::new(),
        };
        println!("  {name:22} {:>8} {:>12} {:>12} {verdict}", cost.count, cost.mean, cost.max);
    }
}

fn golden_path() -> PathBuf {
    shell::root().join("tests/goldens/firmware.json")
}

fn golden() -> Result<Outcome> {
    Ok(serde_json::from_str(&std::fs::read_to_string(golden_path()).context("no golden file")?)?)
}

fn write_golden(golden: &Outcome) -> Result<()> {
    std::fs::write(golden_path(), serde_json::to_string_pretty(golden)? + "\n")?;
    eprintln!("firmware: wrote {}", golden_path().display());
    Ok(())
}

/// Compares with the golden file, or writes it.
fn compare(outcome: &Outcome, update: bool) -> Result<bool> {
    let golden = golden()?;
    if update {
        let mut images = golden.images;
        images.extend(outcome.images.clone());
        write_golden(&Outcome { images, ..outcome.clone() })?;
        return Ok(true);
    }
    let mut good = true;
    for (image, size) in &outcome.images {
        good &= fits(image, *size, false)?;
    }
    for (name, wanted) in &golden.instructions {
        let seen = outcome.instructions.get(name).copied().unwrap_or_default();
        for (what, seen, wanted) in [("mean", seen.mean, wanted.mean), ("most", seen.max, wanted.max)] {
            let change = seen as f64 / (wanted.max(1)) as f64 - 1.0;
            if change.abs() > GATE {
                good = false;
                let percent = change * 100.0;
                eprintln!("firmware: {name}, {what}: {seen} instructions, golden {wanted} ({percent:+.1} %)");
            }
        }
    }
    if !good {
        eprintln!("firmware: if that is meant, run: cargo xtask firmware --update");
    }
    Ok(good)
}
