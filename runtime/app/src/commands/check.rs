//! `floorguard check robot.toml`: is this file good enough to drive with?

use std::path::Path;

use floorguard_drivers::velodyne::Model;
use floorguard_runtime::configuration::ScannerModel;

use floorguard_configuration::{HostedConfiguration, absences, load};

/// Says what the file describes, or everything that is wrong with it.
///
/// # Errors
/// The file is refused.
pub fn run(file: &Path) -> anyhow::Result<()> {
    let configuration = load(file)?;
    let robot = &configuration.robot;
    say!(
        "{}: good: {} fields, lidar {}, scanner {}, {} waypoints, at most {} m/s",
        file.display(),
        robot.fields.len(),
        lidar(&configuration),
        scanner(robot.scanner.model),
        robot.route.waypoints.len(),
        robot.limits.speed_mps,
    );
    say_absences(&configuration);
    if let Some(learning) = &configuration.learning {
        let seconds = learning.update_us as f64 * 1.0e-6;
        match learning.enabled {
            true => say!(
                "  learns the appearance of people, into {}, an update in {seconds} s at most",
                learning.model.display()
            ),
            false => say!("  learning is switched off"),
        }
    }
    Ok(())
}

/// What each missing section costs, a line for each.
pub(super) fn say_absences(configuration: &HostedConfiguration) {
    for absence in absences(configuration) {
        say!("  no [{}]: {}", absence.section, absence.costs);
    }
}

fn lidar(configuration: &HostedConfiguration) -> &'static str {
    match configuration.robot.has_lidar {
        true => configuration.robot.lidar_model().map_or("as its packets say", Model::name),
        false => "none",
    }
}

fn scanner(model: ScannerModel) -> String {
    match model {
        ScannerModel::S300 => "S300".to_owned(),
        ScannerModel::MicroScan3 { beams } => format!("microScan3 with {beams} beams"),
    }
}
