//! The robot, with the route that a tape brings along.

use floorguard_board_support::robot;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tape::{TapeLine, TapeReader, decode_route};

/// Where the emulator puts the tape, and how large it may be: the board's PSRAM.
pub const TAPE_AT: usize = 0x6000_0000;
const TAPE_BYTES: usize = 0x00fe_0000;

/// The tape in the board's memory; `None` where the emulator loaded none.
pub fn tape() -> Option<TapeReader<'static>> {
    // SAFETY: the board has 16 MiB of PSRAM there, of which nothing in this program writes this part.
    let bytes: &'static [u8] =
        unsafe { core::slice::from_raw_parts(core::ptr::with_exposed_provenance(TAPE_AT), TAPE_BYTES) };
    TapeReader::new(bytes)
}

/// The robot with the route of a tape; `None` where the tape does not begin with one.
pub fn robot_for(mut tape: TapeReader<'static>) -> Option<RobotConfiguration> {
    let mut robot = robot();
    let route = tape.next().filter(|record| record.line == TapeLine::Route)?;
    (robot.route, robot.route_limits) = decode_route(route.data)?;
    Some(robot)
}
