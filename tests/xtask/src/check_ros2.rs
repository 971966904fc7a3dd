//! `cargo xtask check-ros2`: the bridge to ROS 2, with another implementation of DDS as the other side.
//!
//! Cyclone DDS comes from the Python registry into a virtual environment under `target/`; with `--rclpy` ROS 2 itself does. Where
//! there is no Python or no registry the check is skipped, and says so. Everything stays on the loopback, without multicast.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context as _, Result, ensure};
use clap::Args;

use crate::shell;

/// Longest run of the robot, seconds; it is ended before, when the other side has seen enough.
const ROBOT_S: &str = "100";
/// Domains that are chosen from, so that runs beside each other do not meet; their ports are below those of short-lived sockets.
const DOMAINS: std::ops::Range<u32> = 20..100;
/// Packages of ROS 2 itself.
const ROS: [&str; 7] = [
    "ros-jazzy-rclpy",
    "ros-jazzy-rmw-fastrtps-cpp",
    "ros-jazzy-std-srvs",
    "ros-jazzy-nav-msgs",
    "ros-jazzy-sensor-msgs",
    "ros-jazzy-diagnostic-msgs",
    "ros-jazzy-visualization-msgs",
];

/// Who the other side is.
#[derive(Args)]
pub struct Options {
    /// ROS 2 Jazzy itself, rclpy over Fast DDS, instead of Cyclone DDS; a quarter of a gigabyte is installed for it.
    #[arg(long)]
    rclpy: bool,
    /// A Python that has the packages already.
    #[arg(long)]
    python: Option<PathBuf>,
}

/// Builds, installs and plays. True when the other side agrees, or there is none.
pub fn run(options: &Options) -> Result<bool> {
    let work = shell::target_folder().join("check-ros2");
    std::fs::create_dir_all(&work)?;
    let python = match options.python.clone().map_or_else(|| environment(&work, options.rclpy), Ok) {
        Ok(python) => python,
        Err(why) => {
            println!("check-ros2: skipped: {why}");
            return Ok(true);
        }
    };
    let program = program("floorguard/ros2")?;
    let domain = domain();
    let mut robot = robot(&program, &domain.to_string())?;
    let script = folder().join(if options.rclpy { "ros.py" } else { "cyclone.py" });
    let agreed = shell::succeeds(Command::new(python).arg(script).arg(domain.to_string()));
    end(&mut robot)?;
    agreed
}

/// The robot's program with these features, built.
pub(crate) fn program(features: &str) -> Result<PathBuf> {
    // With the features of the tests, as `program::built`: otherwise most dependencies are compiled twice.
    let built = ["build", "--quiet", "--workspace", "--bin", "floorguard", "--features", features];
    ensure!(shell::succeeds(shell::cargo().args(built))?, "the robot's program was not built");
    Ok(shell::target_folder().join("debug/floorguard"))
}

/// A domain of this process.
pub(crate) fn domain() -> u32 {
    DOMAINS.start + std::process::id() % (DOMAINS.end - DOMAINS.start)
}

/// Where the programs of the other side are.
pub(crate) fn folder() -> PathBuf {
    shell::root().join("tests/ros2")
}

/// A simulated robot with a person ahead, driven by `/cmd_vel`.
fn robot(program: &Path, domain: &str) -> Result<Child> {
    let mut simulate = Command::new(program);
    simulate.arg("simulate").arg("--scenario").arg(folder().join("person-ahead.toml"));
    simulate.args(["--duration", ROBOT_S, "--command", "ros2:/cmd_vel", "--json"]);
    simulate.arg(format!("--ros2={domain}")).stdin(Stdio::null()).stdout(Stdio::null());
    simulate.spawn().context("cannot start the robot's program")
}

/// As Ctrl-C does, so that the robot says what went over the bridge.
fn end(robot: &mut Child) -> Result<()> {
    Command::new("kill").args(["-INT", &robot.id().to_string()]).status()?;
    robot.wait()?;
    Ok(())
}

/// A virtual environment with the other side.
pub(crate) fn environment(work: &Path, rclpy: bool) -> Result<PathBuf, String> {
    let venv = work.join(if rclpy { "ros" } else { "cyclone" });
    let python = venv.join("bin/python");
    if !python.is_file() {
        let made = shell::output(Command::new("python3").args(["-m", "venv"]).arg(&venv));
        made.ok_or("python3 makes no virtual environment here (install python3-venv)")?;
    }
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    if rclpy {
        pip.args(ROS);
    } else {
        pip.args(["--only-binary", ":all:", "--requirement"]).arg(folder().join("requirements.txt"));
    }
    let installed = shell::output(&mut pip);
    installed
        .map(|_| python)
        .ok_or_else(|| "pip cannot install the other side here (no registry?)".to_owned())
}
