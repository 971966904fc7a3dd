//! What a finished map is on disk: the files of other people's tools, and how they get there whole.

mod cloud;
mod cloud_page;
mod files;
mod folder;
mod las;
mod map_server;
mod picture;
mod submaps;
mod top_view;
mod window_view;

pub use cloud::{cloud_pcd, cloud_ply};
pub(crate) use cloud_page::base64;
pub use cloud_page::{CloudPage, cloud_page};
pub use files::{OutputFile, map_files, map_server_files};
pub use folder::{MARKER, MARKER_3D, ReplaceError, check_place, replace_folder};
pub use las::{LasPoint, cloud_las, las};
pub use map_server::{pgm, yaml};
pub use picture::{Picture, draw};
pub use submaps::{INDEX_HEAD, SubMap, SubMapConfig, SubMaps, index_line};
pub use top_view::{TopView, draw_top_view};
pub use window_view::{ColourOf, PlanLayer, draw_faces, draw_plan, picture_png, plan_map};
