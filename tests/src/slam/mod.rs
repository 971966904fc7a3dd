//! Five published laser logs mapped by our command, and the relation errors beside those of other programs; simulated drives
//! of a spinning lidar through real floor plans, and the absolute errors; drives of the simulated robot beside their true poses.

mod logs;
mod space;
mod table;
mod truth;
mod walls;

pub use logs::text;
pub use space::slam_in_space;
pub use table::slam;
pub use truth::slam_beside_truth;
