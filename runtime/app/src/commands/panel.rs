//! `--panel` of every command that runs a robot.

use std::net::SocketAddr;

use floorguard_runtime::configuration::RobotConfiguration;

use super::exit::BadInput;
use floorguard_operator::panel::{Access, Panel, PanelView};

/// Where a token is configured.
const TOKEN_VARIABLE: &str = "FLOORGUARD_PANEL_TOKEN";

/// Opens the panel of a run and says where it is.
///
/// # Errors
/// The address is taken, or others could reach it without a token.
pub fn open_panel(address: SocketAddr, title: &str, robot: &RobotConfiguration) -> anyhow::Result<Panel> {
    let access = Access::new(address, std::env::var(TOKEN_VARIABLE).ok())
        .map_err(|error| BadInput(error.to_string()))?;
    Panel::open(access, PanelView::new(title, robot)).map_err(|error| BadInput(format!("{error:#}")).into())
}
