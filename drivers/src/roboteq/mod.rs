//! Roboteq motor controllers by their serial line and by CAN (book, Motor controllers: Roboteq, Roboteq by CAN).
//!
//! The line from Roboteq, "Advanced Digital Motor Controller User Manual" V1.8 (August 28, 2017), sections "Serial Communication Protocol",
//! "Runtime Commands" (S, EX, MG), "Runtime Queries" (S, C, FF) and "Set/Read Configuration Commands" (RWD).
//!
//! The bus from Roboteq, "CANBus Networking Manual" V2.0 (July 8, 2019), section 3 "CANopen Interface" with its tables of runtime commands
//! and queries, and the maker's file `roboteq_motor_controllers_v80.eds` (2021-12-14).

mod bus;
mod line;

pub use bus::{BUS_CHANNELS, RoboteqBusOrder, RoboteqBusReport, SCRIPT_RUNS, WATCHDOG_VARIABLE, bus_script};
pub use line::{COMMAND_BYTES_MAX, EMERGENCY_STOPPED, RoboteqOrder, RoboteqReply};

#[cfg(test)]
mod bus_tests;
