//! What is written and shown of a simulated run.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use super::interrupt::end_at_ctrl_c;
use super::live_outputs::LiveOutputs;
use super::panel::{PanelOpening, open_panel};
use super::ros2::RosWay;
use crate::fleets::{CleaningOffer, FleetOpening, join};
use floorguard_configuration::{FleetConfiguration, parse_recorded};
use floorguard_laboratory::world::{Plan, record_plan, record_plan_in_real_time, watch_plan};
use floorguard_operator::telemetry::RunSinks;

/// What is written and shown of a simulated run.
#[derive(Default)]
pub(super) struct SinkOutputs<'a> {
    /// The recording.
    pub record: Option<&'a Path>,
    /// Where the panel listens.
    pub panel: Option<SocketAddr>,
    /// Where the panel keeps its areas, alerts and days.
    pub panel_records: Option<PathBuf>,
    /// What is shown live.
    pub live: LiveOutputs,
    /// The fleet that the robot belongs to.
    pub fleet: Option<FleetConfiguration>,
    /// The bridge to ROS 2.
    pub ros: RosWay,
    /// The run is in real time over real lines.
    pub real_io: bool,
}

/// A recording and a panel, where they are wanted.
pub(super) fn open_sinks(sinks: &mut RunSinks, plan: &Plan, outputs: SinkOutputs<'_>) -> anyhow::Result<()> {
    let SinkOutputs { record, panel, panel_records, live, fleet, ros, real_io } = outputs;
    sinks.compression = live.record_compression.into();
    match record {
        Some(path) if real_io => record_plan_in_real_time(sinks, plan, path)?,
        Some(path) => record_plan(sinks, plan, path)?,
        None => {}
    }
    if let Some(listener) = live.open(&plan.scenario.title)? {
        watch_plan(sinks, plan, listener)?;
    }
    let settings = plan.navigation_settings;
    if let Some((listener, link)) = ros.open(plan.drive_orders.clone().map(|orders| (orders, settings)))? {
        watch_plan(sinks, plan, listener)?;
        sinks.links.push(link);
    }
    if let (Some(fleet), Some(orders)) = (&fleet, plan.drive_orders.clone()) {
        let robot = &plan.robot;
        let mission = plan.mission.as_ref();
        let cleaning = mission.and_then(|mission| CleaningOffer::of(mission, plan.cleaning_orders.clone()));
        let cleaning = cleaning.ok_or_else(|| "this run has no mission".to_owned());
        sinks.links.push(join(FleetOpening { fleet, folder: None, robot, settings, orders, cleaning })?);
    }
    end_at_ctrl_c(&sinks.ended, "the run ends here")?;
    if let Some(address) = panel {
        let configured = parse_recorded("robot.toml", &plan.robot_toml);
        let opening = PanelOpening {
            title: &plan.scenario.title,
            robot: &plan.robot,
            records: panel_records,
            configured: configured.map(|read| read.configuration.panel).unwrap_or_default(),
        };
        sinks.panel = Some(open_panel(address, opening)?);
    }
    Ok(())
}
