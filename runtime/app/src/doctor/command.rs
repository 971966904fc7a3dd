//! `floorguard doctor`: is this computer ready to drive the robot, and what is missing?

use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_configuration::load;
use floorguard_host::executor::grants_real_time;
use floorguard_host::words::counted;
use serde_json::json;

use super::computer::Computer;
use super::finding::{Finding, State};
use super::{devices, system};
use floorguard_host::outcome::VerdictFailed;

/// What to look at.
#[derive(Clone, Debug, Args)]
pub struct DoctorArguments {
    /// The robot's configuration: its lines, ports, CAN interface and pictures are looked at, too. No device is opened.
    pub file: Option<PathBuf>,
    /// One JSON object on standard output instead of words.
    #[arg(long)]
    pub json: bool,
}

/// Says what of this computer the robot can rely on.
///
/// # Errors
/// Something is bad: the robot would not run, or not in time. Or the configuration is refused.
pub fn run(arguments: &DoctorArguments) -> anyhow::Result<()> {
    let configuration = arguments.file.as_deref().map(load).transpose()?;
    let computer = Computer::at(PathBuf::from("/"), grants_real_time());
    let folder = arguments.file.as_deref().and_then(Path::parent).filter(|path| !path.as_os_str().is_empty());
    let mut findings = system::findings(&computer, folder.unwrap_or(Path::new(".")));
    findings.extend(configuration.iter().flat_map(|robot| devices::findings(&computer, &robot.carriers)));
    if arguments.json {
        let object = json!({
            "file": arguments.file.as_ref().map(|file| file.display().to_string()),
            "verdict": verdict(&findings),
            "findings": findings,
        });
        tell!("{object}")?;
    } else {
        findings.iter().for_each(|finding| say!("{finding}"));
        say!("{}", summary(&findings));
    }
    match count(&findings, State::Bad) {
        0 => Ok(()),
        bad => Err(VerdictFailed(format!(
            "the robot cannot rely on this computer: {} bad",
            counted(bad, "finding")
        ))
        .into()),
    }
}

pub(super) fn verdict(findings: &[Finding]) -> &'static str {
    match (count(findings, State::Bad), count(findings, State::Warning)) {
        (0, 0) => "good",
        (0, _) => "good with warnings",
        _ => "failed",
    }
}

fn summary(findings: &[Finding]) -> String {
    let [good, warnings, bad] = [State::Good, State::Warning, State::Bad].map(|state| count(findings, state));
    format!("floorguard doctor: {good} good, {}, {bad} bad", counted(warnings, "warning"))
}

fn count(findings: &[Finding], state: State) -> u32 {
    findings.iter().fold(0, |sum, finding| sum + u32::from(finding.state == state))
}
