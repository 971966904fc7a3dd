//! People: who stops the robot, who limits it, and when a stop for them ends.

mod diverging;
mod doubt;
mod moving_gaps;
mod receding;
