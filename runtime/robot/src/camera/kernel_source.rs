//! A camera of the kernel: devices that are opened when they are there, and again when they have gone.

use std::io;
use std::path::{Path, PathBuf};

use floorguard_types::sensing::ImageSize;
use floorguard_types::time::{Age, Stamp};

use super::device::Device;
use super::frame_source::{FrameEvent, FrameSource};
use super::pixels::{ColourFormat, WrongFrame, colour_of, depth_of};

/// Between attempts to open a device that is not there, microseconds.
const RETRY_US: u64 = 2_000_000;
/// A device that sends nothing for this long is opened again, microseconds.
const SILENT_US: u64 = 2_000_000;
/// Depth in whole millimetres.
const Z16: [u8; 4] = *b"Z16 ";

/// What a device sends.
trait Stream: Sized {
    /// The newest frame that waits.
    fn newest(&mut self) -> io::Result<Option<(Stamp, Vec<u8>)>>;
}

impl Stream for Device {
    fn newest(&mut self) -> io::Result<Option<(Stamp, Vec<u8>)>> {
        Self::newest(self)
    }
}

/// The line to a device, there or not.
struct Line<S> {
    stream: Option<S>,
    retry_at: Stamp,
    last: Stamp,
}

impl<S: Stream> Line<S> {
    const CLOSED: Self = Self { stream: None, retry_at: Stamp::ZERO, last: Stamp::ZERO };

    fn next_event<P>(
        &mut self,
        now: Stamp,
        open: impl FnOnce() -> io::Result<S>,
        unpack: impl FnOnce(&S, &[u8]) -> Result<P, WrongFrame>,
    ) -> FrameEvent<P> {
        let later = |after_us: u64| Stamp::from_micros(now.as_micros().saturating_add(after_us));
        if self.stream.is_none() {
            if now < self.retry_at {
                return FrameEvent::Nothing;
            }
            self.retry_at = later(RETRY_US);
            match open() {
                Ok(stream) => (self.stream, self.last) = (Some(stream), now),
                Err(problem) => return FrameEvent::Silent(problem.to_string()),
            }
        }
        let Some(stream) = &mut self.stream else { return FrameEvent::Nothing };
        let why = match stream.newest() {
            Ok(Some((stamp, bytes))) => {
                self.last = now;
                return match unpack(stream, &bytes) {
                    Ok(picture) => FrameEvent::Picture(stamp, picture),
                    Err(problem) => FrameEvent::Damaged(problem),
                };
            }
            Ok(None) if matches!(self.last.age(now), Age::Past(age_us) if age_us > SILENT_US) => {
                "no pictures any more".to_owned()
            }
            Ok(None) => return FrameEvent::Nothing,
            Err(problem) => problem.to_string(),
        };
        (self.stream, self.retry_at) = (None, later(RETRY_US));
        FrameEvent::Silent(why)
    }
}

/// The devices of a camera.
pub struct KernelSource {
    size: ImageSize,
    depth: (PathBuf, Line<Device>),
    colour: Option<(PathBuf, Line<Device>)>,
}

impl KernelSource {
    /// Devices for depth and colour that show pictures of a size; opened when they are asked for the first time.
    #[must_use]
    pub fn new(depth: &Path, colour: Option<&Path>, size: ImageSize) -> Self {
        let closed = |path: &Path| (path.to_owned(), Line::CLOSED);
        Self { size, depth: closed(depth), colour: colour.map(closed) }
    }
}

impl FrameSource for KernelSource {
    fn name(&self) -> String {
        let colour = self.colour.iter().map(|(path, _)| format!(" and {}", path.display()));
        format!("{}{}", self.depth.0.display(), colour.collect::<String>())
    }

    fn has_colour(&self) -> bool {
        self.colour.is_some()
    }

    fn depth(&mut self, now: Stamp) -> FrameEvent<Vec<u16>> {
        let (size, (path, line)) = (self.size, &mut self.depth);
        line.next_event(
            now,
            || Device::open(path, size, &[Z16]),
            |device, bytes| depth_of(bytes, size, device.line_bytes),
        )
    }

    fn colour(&mut self, now: Stamp) -> FrameEvent<Vec<u8>> {
        let (size, Some((path, line))) = (self.size, &mut self.colour) else { return FrameEvent::Nothing };
        let letters = ColourFormat::ALL.map(|(_, letters)| letters);
        line.next_event(
            now,
            || Device::open(path, size, &letters),
            |device, bytes| {
                let format = ColourFormat::ALL.into_iter().find(|(_, letters)| *letters == device.format);
                let format = format.map_or(ColourFormat::Rgb, |(format, _)| format);
                colour_of(format, bytes, size, device.line_bytes)
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device that sends what is listed, then is unplugged.
    struct Fake(Vec<Option<Vec<u8>>>);

    impl Stream for Fake {
        fn newest(&mut self) -> io::Result<Option<(Stamp, Vec<u8>)>> {
            if self.0.is_empty() {
                return Err(io::Error::other("no such device"));
            }
            Ok(self.0.remove(0).map(|bytes| (Stamp::from_micros(7), bytes)))
        }
    }

    fn next_event(line: &mut Line<Fake>, at_ms: u64, frames: Vec<Option<Vec<u8>>>) -> FrameEvent<Vec<u16>> {
        let now = Stamp::from_micros(1_000 * at_ms);
        line.next_event(
            now,
            || Ok(Fake(frames)),
            |_, bytes| depth_of(bytes, ImageSize { width: 2, height: 1 }, 0),
        )
    }

    /// An unplugged device is reported, left alone for two seconds, and opened again; a cut frame is no
    /// picture.
    #[test]
    fn a_device_may_go_and_come_back() {
        let mut line = Line::CLOSED;
        let good = || Some(vec![1, 0, 2, 0]);
        let picture = FrameEvent::Picture(Stamp::from_micros(7), vec![1, 2]);
        assert_eq!(next_event(&mut line, 10, vec![good(), None, Some(vec![1]), good()]), picture);
        assert_eq!(next_event(&mut line, 20, vec![]), FrameEvent::Nothing);
        assert_eq!(
            next_event(&mut line, 30, vec![]),
            FrameEvent::Damaged(WrongFrame::Short { bytes: 1, needed: 4 })
        );
        assert_eq!(next_event(&mut line, 40, vec![]), picture);
        assert_eq!(next_event(&mut line, 50, vec![]), FrameEvent::Silent("no such device".to_owned()));
        assert_eq!(next_event(&mut line, 2_040, vec![good()]), FrameEvent::Nothing, "not yet");
        assert_eq!(next_event(&mut line, 2_050, vec![good()]), picture);
    }

    #[test]
    fn a_device_that_sends_nothing_is_opened_again() {
        let mut line = Line::CLOSED;
        assert_eq!(next_event(&mut line, 10, vec![None; 9]), FrameEvent::Nothing);
        assert_eq!(next_event(&mut line, 2_010, vec![]), FrameEvent::Nothing);
        assert_eq!(
            next_event(&mut line, 2_020, vec![]),
            FrameEvent::Silent("no pictures any more".to_owned())
        );
        let absent = || Err(io::Error::other("not there"));
        let at = Stamp::from_micros(4_020_000);
        let unpack = |_: &Fake, bytes: &[u8]| depth_of(bytes, ImageSize { width: 2, height: 1 }, 0);
        assert_eq!(line.next_event(at, absent, unpack), FrameEvent::Silent("not there".to_owned()));
    }
}
