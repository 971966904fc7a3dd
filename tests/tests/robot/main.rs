//! The whole robot in virtual time, under faults and fuzzed inputs; the guard against its requirements.

mod bases;
mod config_single_mistakes;
mod environment_learning;
mod fault_campaign;
mod fault_findings;
mod firmware_contacts;
mod firmware_faults;
mod fuzz_decoders;
mod fuzz_runtime;
mod guard_requirements;
mod guard_second_model;
mod guard_under_navigation;
mod learning_robot;
mod recording_mcap;
mod recording_replay;
mod robot_in_virtual_time;
mod roboteq_bus;
