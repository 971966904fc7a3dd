//! What the user types. Human text goes to standard error, machine output to standard output.

mod arguments;
mod ask;
mod blackbox;
mod campaign;
mod check;
mod decode;
mod demo;
mod eval;
mod exit;
mod interrupt;
mod learn;
mod live;
mod live_camera;
mod mission;
mod panel;
mod replay;
mod report;
mod run;
mod simulate;
mod train;

pub use arguments::{Arguments, Command, DecodeArguments, ModelArgument, ReplayArguments};
pub use ask::{AskArguments, AskQuestion};
pub use blackbox::BlackBoxArguments;
pub use campaign::{CampaignArguments, CampaignKind};
pub use decode::decode_to;
pub(crate) use decode::{LIDAR_DATA_PORT, settle_model};
pub use demo::DemoArguments;
pub use eval::{EvalArguments, EvalStage};
pub use exit::{BadInput, VerdictFailed, exit_code, is_broken_pipe};
pub use learn::{LearnArguments, PlaceArguments};
pub use mission::MissionArguments;
pub use panel::open_panel;
pub use report::ReportArguments;
pub use run::RunArguments;
pub use simulate::SimulateArguments;
pub use train::{TrainArguments, TrainPeopleArguments, TrainWhat};

/// Runs the command.
///
/// # Errors
/// Anything that ends the program with another exit code than 0, see [`exit_code`].
pub fn dispatch(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Some(Command::Replay(arguments)) => replay::run(&arguments),
        Some(Command::Blackbox(arguments)) => blackbox::run(&arguments),
        Some(Command::Report(arguments)) => report::run(&arguments),
        Some(Command::Decode(arguments)) => decode::run(&arguments),
        Some(Command::Mission(arguments)) => mission::run(&arguments),
        Some(Command::Learn(arguments)) => learn::run(&arguments),
        Some(Command::Ask(arguments)) => ask::run(&arguments),
        Some(Command::Train(arguments)) => train::run(&arguments),
        Some(Command::Eval(arguments)) => eval::run(&arguments),
        Some(Command::Check { file }) => check::run(&file),
        Some(Command::Simulate(arguments)) => simulate::run(&arguments),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Demo(arguments)) => demo::run(&arguments),
        Some(Command::Campaign(arguments)) => campaign::run(&arguments),
        None => demo::run(&DemoArguments::default()),
    }
}
