//! What a run writes of its maps: what the scanner saw, dirt, a mission's floor, a drive's plan.

use std::io::{Seek, Write};
use std::sync::Arc;

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_runtime::shared::Shared;
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

use floorguard_robot::camera::SeenDirt;
use floorguard_robot::cleaner::MissionProgress;
use floorguard_robot::navigator::NavigationProgress;

use super::RunRecorder;
use crate::messages::GridImage;
use crate::{mission, scan_map, topics};

/// The map takes two scans a second, microseconds.
const MAP_SCAN_US: u64 = 500_000;
/// Maps are written this often, microseconds.
const MAPS_EVERY_US: u64 = 5_000_000;

impl<W: Write + Seek> RunRecorder<W> {
    pub(super) fn map<M: RawMutex>(&mut self, shared: &Shared<M>, scan: &Scan, now_us: u64) {
        let mounting = self.mountings.iter().find(|(name, _)| *name == "scanner").map(|(_, at)| *at);
        if now_us >= self.seen.map_scan_us
            && let (Some(pose), Some(mounting)) = (shared.pose.get(), mounting)
        {
            self.seen.map_scan_us = now_us + MAP_SCAN_US;
            self.map.add(scan, &mounting, pose.pose_in_odometry);
        }
        if now_us >= self.seen.map_us {
            self.seen.map_us = now_us + MAPS_EVERY_US;
            self.write_map(now_us);
        }
    }

    pub(super) fn write_map(&mut self, now_us: u64) {
        let Some(picture) = self.map.picture() else { return };
        let grid = GridImage {
            resolution_m: scan_map::CELL_M,
            width: picture.width,
            origin: picture.origin,
            cells: &picture.cells,
        };
        self.write(|out| out.map(topics::MAP, (Stamp::from_micros(now_us), "odom"), &grid));
    }

    /// The floor camera's map of dirt as it is now: percent of heat, −1 unknown.
    pub fn seen_dirt(&mut self, seen: &SeenDirt) {
        let now = Stamp::from_micros(self.seen.now_us);
        let (geometry, [_, live]) = (&seen.geometry, &seen.layers);
        let corner = geometry.origin_in_map();
        let grid = GridImage {
            resolution_m: geometry.resolution_m(),
            width: geometry.width().into(),
            origin: Pose2::new(corner.x_m, corner.y_m, 0.0),
            cells: live,
        };
        self.write(|out| out.map(topics::SEEN_DIRT, (now, "odom"), &grid));
    }

    /// The cleaning mission has reported its progress.
    pub fn mission(&mut self, progress: &Arc<MissionProgress>) {
        let now_us = self.seen.now_us;
        let now = Stamp::from_micros(now_us);
        let odometry = progress.odometry_in_map;
        self.write(|out| out.frame(now, now, (("map", "odom"), odometry)));
        self.write(|out| out.diagnostics(topics::DIAGNOSTICS, now, &[mission::diagnostic(progress)]));
        if self.seen.mission_us.is_none() {
            self.write_dirt(progress, &progress.expected_before, now);
        }
        let due = self.seen.mission_us.is_none_or(|last_us| now_us >= last_us + MAPS_EVERY_US);
        if due || self.seen.phase != Some(progress.phase) {
            self.seen.phase = Some(progress.phase);
            self.write_mission(progress, now_us);
            self.mission = None;
        } else {
            // Written at the end, should nothing newer come.
            self.mission = Some(Arc::clone(progress));
        }
    }

    /// The drive to a goal has reported its progress: its plan and costmap are written when they change.
    pub fn navigation(&mut self, progress: &Arc<NavigationProgress>) {
        let now = Stamp::from_micros(self.seen.now_us);
        let mut drive = std::mem::take(&mut self.drive);
        self.write(|out| drive.write(out, (progress, now)));
        self.drive = drive;
    }

    pub(super) fn write_mission(&mut self, progress: &MissionProgress, now_us: u64) {
        let now = Stamp::from_micros(now_us);
        self.seen.mission_us = Some(now_us);
        let cells = mission::claimed_cells(progress);
        self.write(|out| out.map(topics::CLAIMED, (now, "map"), &mission::grid(progress, &cells)));
        self.write_dirt(progress, &progress.expected_now, now);
    }

    fn write_dirt(&mut self, progress: &MissionProgress, units: &[f32], now: Stamp) {
        let cells = mission::dirt_cells(progress, units);
        self.write(|out| out.map(topics::DIRT, (now, "map"), &mission::grid(progress, &cells)));
    }
}
