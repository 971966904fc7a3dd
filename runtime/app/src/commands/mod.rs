//! What the user types. Human text goes to standard error, machine output to standard output.

mod arguments;
#[cfg(feature = "laboratory")]
mod campaign;
#[cfg(feature = "laboratory")]
mod campaign_contacts;
#[cfg(feature = "laboratory")]
mod choices;
#[cfg(feature = "laboratory")]
mod demo;
mod exit;
mod explore;
#[cfg(feature = "laboratory")]
mod explore_simulated;
mod goto;
#[cfg(feature = "laboratory")]
mod heartbeat;
mod interrupt;
mod live;
mod live_camera;
mod live_outputs;
mod manual;
mod map_here;
#[cfg(feature = "laboratory")]
mod mission;
#[cfg(feature = "laboratory")]
mod mission_table;
#[cfg(feature = "laboratory")]
mod mission_verdict;
mod panel;
mod ros2;
mod run;
mod run_begin;
#[cfg(feature = "laboratory")]
mod run_lesson;
#[cfg(feature = "laboratory")]
mod simulate;
#[cfg(feature = "laboratory")]
mod simulated_places;
#[cfg(feature = "laboratory")]
mod sinks;
#[cfg(feature = "laboratory")]
mod tape;
mod tour;
mod values;

#[cfg(feature = "laboratory")]
pub use crate::evaluation::RecordedStage;
pub use crate::evaluation::{EvalArguments, EvalStage};
pub use crate::learning::{AskArguments, AskQuestion, LearnArguments, PlaceArguments};
#[cfg(feature = "laboratory")]
pub use crate::learning::{TrainArguments, TrainPeopleArguments, TrainWhat};
pub use crate::reports::{ExplainArguments, ReportArguments};
pub use crate::robot_file::{CheckArguments, LidarMetadataArguments};
pub use arguments::{Arguments, Command};
#[cfg(feature = "laboratory")]
pub use campaign::{CampaignArguments, CampaignKind};
#[cfg(feature = "laboratory")]
pub use demo::DemoArguments;
pub use exit::{BadInput, VerdictFailed, WrongUsage, exit_code, is_broken_pipe};
pub use explore::ExploreArguments;
pub use goto::GotoArguments;
pub use manual::ManualArguments;
#[cfg(feature = "laboratory")]
pub use mission::MissionArguments;
pub use panel::{PanelOpening, open_panel, records_beside};
pub use run::RunArguments;
#[cfg(feature = "laboratory")]
pub use simulate::SimulateArguments;
#[cfg(feature = "laboratory")]
pub use tape::TapeArguments;
pub use tour::TourArguments;

use crate::{
    cameras, doctor, evaluation, learning, mapping_commands, recordings, reports, robot_file, window,
};

/// Runs the command.
///
/// # Errors
/// Anything that ends the program with another exit code than 0, see [`exit_code`].
pub fn dispatch(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Some(Command::Replay(arguments)) => recordings::replay(&arguments),
        Some(Command::Blackbox(arguments)) => reports::blackbox(&arguments),
        Some(Command::Report(arguments)) => reports::run(&arguments),
        Some(Command::Explain(arguments)) => crate::reports::explain(&arguments),
        Some(Command::Decode(arguments)) => recordings::decode(&arguments),
        Some(Command::Inspect(arguments)) => recordings::inspect(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Mission(arguments)) => mission::run(&arguments),
        Some(Command::Learn(arguments)) => learning::learn(&arguments),
        Some(Command::Ask(arguments)) => learning::ask(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Train(arguments)) => learning::train(&arguments),
        Some(Command::Map(arguments)) => mapping_commands::map(&arguments),
        Some(Command::Map3d(arguments)) => mapping_commands::map3d(&arguments),
        Some(Command::CleanMap(arguments)) => mapping_commands::clean_map(&arguments),
        Some(Command::Calibrate(arguments)) => cameras::calibrate(&arguments),
        #[cfg(feature = "detector")]
        Some(Command::DetectPeople(arguments)) => cameras::detect_people(&arguments),
        Some(Command::Window(arguments)) => window::run(&arguments),
        Some(Command::Localise(arguments)) => mapping_commands::localise(&arguments),
        Some(Command::Manual(arguments)) => manual::run(&arguments),
        Some(Command::Eval(arguments)) => evaluation::run(&arguments),
        Some(Command::Check(arguments)) => robot_file::check(&arguments),
        Some(Command::LidarMetadata(arguments)) => robot_file::lidar_metadata(&arguments),
        Some(Command::Doctor(arguments)) => doctor::run(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Simulate(arguments)) => simulate::run(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Tape(arguments)) => tape::run(&arguments),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Goto(arguments)) => goto::run(&arguments),
        Some(Command::Tour(arguments)) => tour::run(&arguments),
        Some(Command::Explore(arguments)) => explore::run(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Demo(arguments)) => demo::run(&arguments),
        #[cfg(feature = "laboratory")]
        Some(Command::Campaign(arguments)) => campaign::run(&arguments),
        #[cfg(feature = "laboratory")]
        None => demo::run(&DemoArguments::default()),
        #[cfg(not(feature = "laboratory"))]
        None => Ok(()),
    }
}
