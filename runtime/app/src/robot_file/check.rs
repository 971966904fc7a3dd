//! `floorguard check robot.toml`: is this file good enough to drive with, and what do the sensors of this robot not see?

mod json;
mod picture;

use std::path::PathBuf;

use clap::Args;
use floorguard_configuration::{
    Coverage, Direction, HostedConfiguration, Refusal, SensorGap, SpeedStep, Unseen, absences, load,
};
use floorguard_drivers::velodyne::Model;
use floorguard_runtime::configuration::{LidarModel, ScannerModel};
use floorguard_types::capacities::SWEEP_RINGS;

use floorguard_host::outcome::{BadInput, VerdictFailed};

/// What to check.
#[derive(Clone, Debug, Args)]
pub struct CheckArguments {
    /// The configuration.
    pub file: PathBuf,
    /// Draw from above where the body goes and what no sensor sees there.
    #[arg(long, value_name = "FILE.svg")]
    pub picture: Option<PathBuf>,
    /// One JSON object on standard output instead of words.
    #[arg(long)]
    pub json: bool,
}

/// Reports what the file describes and what its sensors do not see, or everything that is wrong with it.
///
/// # Errors
/// The file is refused, or it does not accept by name what no sensor sees.
pub fn run(arguments: &CheckArguments) -> anyhow::Result<()> {
    let configuration = load(&arguments.file)?;
    let (coverage, refusals) = configuration.coverage();
    if let Some(path) = &arguments.picture {
        std::fs::write(path, picture::draw(&configuration, &coverage))
            .map_err(|error| BadInput(format!("{}: cannot be written ({error})", path.display())))?;
    }
    if arguments.json {
        tell!("{}", json::text(arguments, &configuration, (&coverage, &refusals))?)?;
    } else {
        describe(arguments, &configuration, refusals.is_empty());
        for gap in &coverage.gaps {
            let is_accepted = configuration.accepted_gaps.iter().any(|accepted| accepted.is_same(&gap.gap));
            say!("  {} {}", if is_accepted { "accepted" } else { "NOT ACCEPTED" }, words(gap));
        }
        say_limits(&configuration, &coverage);
    }
    match refusals.first() {
        None => Ok(()),
        Some(_) => Err(VerdictFailed(listed(&refusals)).into()),
    }
}

/// All that sensors and list of accepted gaps do not agree about, a line each.
pub(crate) fn listed(refusals: &[Refusal]) -> String {
    refusals.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n  ")
}

fn describe(arguments: &CheckArguments, configuration: &HostedConfiguration, is_good: bool) {
    let robot = &configuration.robot;
    say!(
        "{}: {}: {} fields, lidar {}, scanner {}, {} waypoints, at most {} m/s",
        arguments.file.display(),
        if is_good { "good" } else { "read" },
        robot.fields.len(),
        lidar(configuration),
        [scanner(robot.scanner.model)]
            .into_iter()
            .chain(robot.rear_scanner.map(|rear| format!("rear scanner {}", scanner(rear.model))))
            .collect::<Vec<_>>()
            .join(", "),
        robot.route.waypoints.len(),
        robot.limits.speed_mps,
    );
    say_absences(configuration);
    if let Some(actuated) = &configuration.carriers.actuated_lidar {
        say!("  {}", actuated.words());
    }
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
    for warning in configuration.warnings() {
        say!("  warning: {warning}");
    }
    say!(
        "  what no sensor sees where the body goes (objects 10 cm wide, bars 3 cm thick; speeds of its fastest point):"
    );
}

/// What the gaps cost in speed, by direction.
fn say_limits(configuration: &HostedConfiguration, coverage: &Coverage) {
    say!("  what that costs (speeds of the fastest point of the body):");
    let limits = configuration.direction_limits(coverage);
    for limit in &limits {
        say!("  {limit}");
    }
    say!("  {} of {} directions are slower than [limits]", limits.len(), Direction::ALL.len());
    let unseen = &configuration.robot.unseen;
    if unseen.known_after_m > 0.0 {
        say!(
            "  turns at most {:.2} m/s until the robot has driven {:.2} m ahead, and after half a minute of standing: no sensor \
             looks beside the rear",
            unseen.unknown_rear_mps,
            unseen.known_after_m
        );
    }
}

/// One gap: how fast the body comes there, where it is widest, in which motion from which speed on.
fn words(gap: &SensorGap) -> String {
    let motions = gap.motions.iter().map(|motion| {
        let step = |step: &SpeedStep| {
            let [low_m, high_m] = step.heights_m;
            match gap.gap.unseen {
                Unseen::Hanging(_) => format!("{low_m:.2} to {high_m:.2} m from {:.2} m/s", step.from_mps),
                _ => format!("{high_m:.2} m from {:.2} m/s", step.from_mps),
            }
        };
        let steps: Vec<String> = motion.steps.iter().map(step).collect();
        format!("      {}: {}", motion.motion.name(), steps.join(", "))
    });
    let [least, greatest] = gap.around_m;
    let places =
        format!("x {:.2} to {:.2} m, y {:.2} to {:.2} m", least.x_m, greatest.x_m, least.y_m, greatest.y_m);
    let motions: Vec<String> = motions.collect();
    format!("{}: touched at up to {:.2} m/s; {places}\n{}", gap.gap, gap.reached_mps(), motions.join("\n"))
}

/// What each missing section costs, a line for each.
pub(crate) fn say_absences(configuration: &HostedConfiguration) {
    for absence in absences(configuration) {
        say!("  no [{}]: {}", absence.section, absence.costs);
    }
}

fn lidar(configuration: &HostedConfiguration) -> String {
    let robot = &configuration.robot;
    match robot.lidar.model {
        _ if !robot.has_lidar => "none".to_owned(),
        LidarModel::PandarXt16 => "PandarXT-16".to_owned(),
        LidarModel::PandarXt32 => "PandarXT-32, every second ring, people in the others once more".to_owned(),
        LidarModel::Ouster(beams) => {
            let rings = beams.rings(SWEEP_RINGS);
            let limits =
                [rings.first(), rings.last()].map(|ring| ring.map_or(0.0, |ring| beams.elevation_deg(*ring)));
            let [lowest, highest] = limits;
            let second = beams.second_rings();
            let more = if second.is_empty() { "" } else { ", people in 16 between these once more" };
            format!(
                "Ouster with {} beams, {} of them from {lowest:.1}° to {highest:.1}°{more}",
                beams.channels,
                rings.len()
            )
        }
        LidarModel::Bridged(_) => "by columns of a bridge".to_owned(),
        LidarModel::LivoxMid360([lowest, .., highest]) => {
            let [lowest, highest] = [lowest, highest].map(|mdeg| f64::from(*mdeg) * 1.0e-3);
            format!("Livox Mid-360, its points from {lowest:.1}° to {highest:.1}° as 16 rings")
        }
        _ => robot.lidar_model().map_or("as its packets say", Model::name).to_owned(),
    }
}

fn scanner(model: ScannerModel) -> String {
    match model {
        ScannerModel::S300 => "S300".to_owned(),
        ScannerModel::MicroScan3 { beams } => format!("microScan3 with {beams} beams"),
        ScannerModel::Ranging(ranging) => format!("{}, no safety device", ranging.name()),
    }
}
