//! What both rings share, on a machine whose rings are interrupt levels.

use core::mem::MaybeUninit;

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use floorguard_guard::GuardConfigError;
use floorguard_runtime::clock::now;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{Motion, Shared};
use static_cell::StaticCell;

/// What both rings share.
pub type RobotShared = Shared<CriticalSectionRawMutex>;

/// Builds it for a robot. Call once.
///
/// # Errors
/// The guard refuses the robot.
pub fn share(robot: &RobotConfiguration) -> Result<&'static RobotShared, GuardConfigError> {
    static SHARED: StaticCell<RobotShared> = StaticCell::new();
    let shared = place(SHARED.uninit(), Motion::new(robot.wheels()));
    shared.configure(robot.guard(), now())?;
    Ok(shared)
}

/// Apart from who never returns: it passes over the stack once, and that is free again afterwards.
#[inline(never)]
fn place(slot: &'static mut MaybeUninit<RobotShared>, motion: Motion) -> &'static RobotShared {
    slot.write(RobotShared::unconfigured(motion))
}
