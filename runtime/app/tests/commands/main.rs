//! The program's commands as a user meets them. What runs in real time beside a panel is in programs of its own.

mod ask_command;
mod blackbox_command;
mod book;
mod goto_command;
mod ground_command;
mod inspect_command;
mod map_edit;
mod mission_command;
mod mission_seen;
mod my_robot_page;
mod panel_browser;
mod panel_pictures;
mod phone_browser;
mod replay_command;
mod replay_of_runs;
mod replay_pipeline;
mod replay_tape;
mod report_command;
mod safety_layer_page;
mod seen_support;
mod slam_commands;
mod space_colours;
mod space_room;
mod status_report;
mod terminal;
mod written_languages;
