//! `--panel` of every command that runs a robot.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use floorguard_configuration::PanelConfiguration;
use floorguard_runtime::configuration::RobotConfiguration;

use super::exit::BadInput;
use floorguard_operator::panel::{Access, Panel, PanelView, Records, Tokens};

/// Where the tokens of viewers, operators and technicians are configured.
const VIEWER_VARIABLE: &str = "FLOORGUARD_PANEL_VIEWER_TOKEN";
const OPERATOR_VARIABLE: &str = "FLOORGUARD_PANEL_TOKEN";
const TECHNICIAN_VARIABLE: &str = "FLOORGUARD_PANEL_TECHNICIAN_TOKEN";

/// What the panel keeps lies beside the robot's file.
#[must_use]
pub fn records_beside(robot_toml: &Path) -> PathBuf {
    robot_toml.with_extension("panel.json")
}

/// What a panel shows and where it keeps its areas, alerts and days; without a file, for this run only.
pub struct PanelOpening<'a> {
    /// What runs.
    pub title: &'a str,
    /// The robot.
    pub robot: &'a RobotConfiguration,
    /// The file.
    pub records: Option<PathBuf>,
    /// What the page shows besides the robot.
    pub configured: PanelConfiguration,
}

/// Opens the panel of a run and says where it is.
///
/// # Errors
/// The address is taken, or others could reach it without a token.
pub fn open_panel(address: SocketAddr, opening: PanelOpening<'_>) -> anyhow::Result<Panel> {
    let variable = |name: &str| std::env::var(name).ok();
    let tokens = Tokens {
        viewer: variable(VIEWER_VARIABLE),
        operator: variable(OPERATOR_VARIABLE),
        technician: variable(TECHNICIAN_VARIABLE),
    };
    let access = Access::new(address, tokens).map_err(|error| BadInput(error.to_string()))?;
    let view = PanelView::new(opening.title, opening.robot).showing(&opening.configured);
    Panel::open(access, view, Records::open(opening.records))
        .map_err(|error| BadInput(format!("{error:#}")).into())
}
