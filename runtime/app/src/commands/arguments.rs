//! The command line.

use clap::{Parser, Subcommand};

use crate::cameras::CalibrateArguments;
use crate::mapping_commands::{CleanArguments, LocaliseArguments, Map3dArguments, MapArguments};
use crate::recordings::{DecodeArguments, InspectArguments, ReplayArguments};

/// From a robot's file to the proof and the explanation of a day.
const EXAMPLES: &str = "Examples:\n  floorguard check robot.toml\n  \
floorguard run robot.toml --panel 127.0.0.1:8080 --record today.mcap\n  \
floorguard report today.mcap --pdf proof.pdf --language de\n  \
floorguard explain today.mcap --at 43.8 --out why.html";

/// On-robot software for a floor-cleaning robot among people: perceives, guards, records.
#[derive(Debug, Parser)]
#[command(name = "floorguard", version, about, after_help = EXAMPLES)]
#[cfg_attr(not(feature = "laboratory"), command(arg_required_else_help = true))]
pub struct Arguments {
    /// What to do; without a command: the demo.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// One task.
#[derive(Debug, Subcommand)]
pub enum Command {
    #[cfg(feature = "laboratory")]
    /// Three simulated minutes of a supermarket: live status, verdict, and a report with a picture.
    #[command(after_help = "Example:\n  floorguard demo --report my-report")]
    Demo(super::DemoArguments),
    /// Run the robot on real devices.
    #[command(
        after_help = "Examples:\n  floorguard check robot.toml\n  floorguard run robot.toml --panel 127.0.0.1:8080 --record today.mcap --black-box stops"
    )]
    Run(super::RunArguments),
    /// Drive the robot on real devices to a place of the map in [navigation], and end there.
    #[command(
        after_help = "Examples:\n  floorguard goto 14.5 4.5 90\n  floorguard goto 14.5 4.5 90 robot.toml --json --record drive.mcap"
    )]
    Goto(super::GotoArguments),
    /// Drive the robot on real devices to one place of its map after another, and look from each: what people hid is seen.
    #[command(
        after_help = "Examples:\n  floorguard tour clean/revisits.csv robot.toml --record revisit.mcap\n  floorguard simulate --scenario office --tour places.csv --duration 600"
    )]
    Tour(super::TourArguments),
    /// Let the robot find its way over floor of which there is no map, until nothing that it can reach is unknown, and write the
    /// map.
    #[command(
        after_help = "Examples:\n  floorguard explore robot.toml --out hall --record first-drive.mcap\n  floorguard explore --scenario supermarket --seed 1 --out supermarket-map"
    )]
    Explore(super::ExploreArguments),
    #[cfg(feature = "laboratory")]
    /// Drive the simulated robot through a scenario and judge it by ground truth.
    #[command(
        after_help = "Example:\n  floorguard simulate --scenario supermarket --seed 1 --duration 60 --emergency-stop 20..25"
    )]
    Simulate(super::SimulateArguments),
    #[cfg(feature = "laboratory")]
    /// Write a recorded lidar as a tape for the emulated board; `cargo xtask firmware --replay FILE` plays it there.
    #[command(after_help = "Example:\n  floorguard tape puck.pcap.gz --out puck.tape --duration 5")]
    Tape(super::TapeArguments),
    #[cfg(feature = "laboratory")]
    /// Many seeded runs on all cores: encounters with people, faults, worlds judged for contacts by true geometry.
    #[command(after_help = "Example:\n  floorguard campaign encounters --trials 100 --seed 1")]
    Campaign(super::CampaignArguments),
    /// Feed a recording, a lidar capture, a ROS 2 bag or a laser log through the same stages as on the robot.
    #[command(
        after_help = "Examples:\n  floorguard replay run.mcap --check\n  floorguard replay puck.pcap.gz --json"
    )]
    Replay(ReplayArguments),
    /// Write the report of a recording: one HTML file with map, stops, speeds, people and health.
    #[command(
        after_help = "Example:\n  floorguard report run.mcap --operator \"A. Smith\" --pdf proof.pdf --json run.json --cells run.csv"
    )]
    Report(super::ReportArguments),
    /// Say why the robot stopped: what each sensor saw, which rule decided, what would have happened otherwise.
    #[command(after_help = "Example:\n  floorguard explain run.mcap --at 43.8 --out why.html")]
    Explain(super::ExplainArguments),
    /// Read the log of a black box and make it a recording.
    #[command(after_help = "Example:\n  floorguard blackbox stop-1.log --out stop-1.mcap")]
    Blackbox(crate::reports::BlackBoxArguments),
    /// Print every return of a lidar capture, or every sample of an inertial sensor's bytes.
    #[command(after_help = "Example:\n  floorguard decode puck.pcap --csv > points.csv")]
    Decode(DecodeArguments),
    /// Say what is in a recording, what is wrong with it, and what can be done with it.
    #[command(after_help = "Example:\n  floorguard inspect run.mcap")]
    Inspect(InspectArguments),
    #[cfg(feature = "laboratory")]
    /// Clean a map in simulation with a guarantee, and compare strategies.
    #[command(
        after_help = "Example:\n  floorguard mission --map hall.yaml --dirt random:5%:10-15 --report hall"
    )]
    Mission(super::MissionArguments),
    /// Learn where and when people walk, from recorded tracks, into the environment model of a place.
    #[command(
        after_help = "Example:\n  floorguard learn tracks.csv --start 2026-04-06T08:00 --timezone Europe/Berlin"
    )]
    Learn(super::LearnArguments),
    /// Ask the environment model: best time, best zone, wet or dry, where dirt, where people.
    #[command(after_help = "Example:\n  floorguard ask best-time --zone aisle=0,0,12,3 --minutes 30")]
    Ask(super::AskArguments),
    #[cfg(feature = "laboratory")]
    /// Learn a classifier and write it as a table of the core.
    #[command(
        after_help = "Example:\n  floorguard train online --place hall --seconds 120 --model people.learned --out lesson"
    )]
    Train(super::TrainArguments),
    /// Write man pages and the completions of shells into a folder.
    #[command(after_help = "Example:\n  floorguard manual --out manual\n  man manual/floorguard-run.1")]
    Manual(super::ManualArguments),
    /// Map a building: a drive's scans become a map, a trajectory and a pose graph.
    Map(MapArguments),
    /// Map a building in space: a lidar capture becomes a trajectory and a cloud of surfaces.
    #[command(name = "map3d")]
    Map3d(Map3dArguments),
    /// Take what moved out of a lidar capture: clouds without people, and what was removed.
    CleanMap(CleanArguments),
    /// Find out where sensors are mounted, from points picked in the data of both.
    #[command(
        after_help = "Example:\n  floorguard calibrate camera-lidar pairs.csv --camera front.json --out front-mounted.json"
    )]
    Calibrate(CalibrateArguments),
    #[cfg(feature = "detector")]
    /// Find people in pictures by a detector that you bring, for `clean-map --boxes`.
    DetectPeople(crate::cameras::DetectArguments),
    /// See with a lidar that a motor turns: surfaces around the robot, floor and ceiling, people, from a recording or a simulated
    /// room.
    Window(crate::window::WindowArguments),
    /// Find a robot in a known map without a hint; "I do not know" is an answer.
    Localise(LocaliseArguments),
    /// Compare a stage with recorded truth or with an independent key.
    #[command(after_help = "Example:\n  floorguard eval tracks --truth truth.txt --result result.txt")]
    Eval(super::EvalArguments),
    /// Check a configuration: every mistake with line, limit and remedy, and what the robot's sensors do not see.
    #[command(after_help = "Example:\n  floorguard check robot.toml --picture unseen.svg")]
    Check(super::CheckArguments),
    /// Write the keys of [lidar] for an Ouster from the metadata that it serves.
    #[command(
        after_help = "Example:\n  curl http://os-122xxx.local/api/v1/sensor/metadata > os1.json\n  floorguard lidar-metadata os1.json"
    )]
    LidarMetadata(super::LidarMetadataArguments),
    /// Look at this computer: kernel, priorities, buffers, clock, and the devices that a configuration names.
    #[command(
        after_help = "Example:\n  floorguard doctor robot.toml\n\nExit codes: 0 good, perhaps with warnings; 1 something is bad; 3 bad input."
    )]
    Doctor(crate::doctor::DoctorArguments),
}
