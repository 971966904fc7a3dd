//! Perception and its measures, on recordings and on drawn scenes.

mod eval_bad_files;
mod floor_bad_input;
mod floor_camera;
mod floor_dirt;
mod floor_map;
mod floor_objects;
mod floor_recordings;
mod legs_leigh;
mod motion_corridor;
mod motion_fabu;
mod people_boxes;
mod people_candidates;
mod people_crowds;
mod people_detector;
mod people_eval;
mod people_fabu;
mod people_filters;
mod people_fusion;
mod people_online;
mod people_removal;
mod people_svm;
mod people_synthetic;
mod rgbd_people;
mod sliding_window;
mod sliding_window_recordings;
mod tracking_metrics;
