//! Where pictures come from, and what each of the two streams has to say.

use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImageSize;
use floorguard_types::time::Stamp;

use super::pixels::WrongFrame;

/// What a stream has to say.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameEvent<P> {
    /// Nothing new.
    Nothing,
    /// A picture, and when it was taken.
    Picture(Stamp, P),
    /// Something came that is no picture.
    Damaged(WrongFrame),
    /// No pictures come: why. Reported again at every attempt to get some.
    Silent(String),
}

/// A colour picture for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColourPicture {
    /// Red, green, blue, row by row from the top left.
    pub rgb: Vec<u8>,
    /// Columns and rows.
    pub size: ImageSize,
}

/// A depth camera with or without a colour camera beside it.
pub trait FrameSource {
    /// What the console shows of it.
    fn name(&self) -> String;

    /// True if there is a colour camera.
    fn has_colour(&self) -> bool;

    /// The newest depth picture, whole millimetres.
    fn depth(&mut self, now: Stamp) -> FrameEvent<Vec<u16>>;

    /// The newest colour picture: red, green, blue.
    fn colour(&mut self, now: Stamp) -> FrameEvent<Vec<u8>>;

    /// From where the robot took the newest depth picture, if the pictures know; otherwise its odometry does.
    fn pose(&self) -> Option<Pose2> {
        None
    }
}
