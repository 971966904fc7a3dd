//! One device of the kernel: a size and a format agreed, frames taken as they come.

use std::io;
use std::path::Path;

use floorguard_runtime::clock;
use floorguard_types::sensing::ImageSize;
use floorguard_types::time::Stamp;
use linuxvideo::format::{PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;

/// A device that streams.
pub struct Device {
    stream: ReadStream,
    /// The four letters of the format.
    pub format: [u8; 4],
    /// Bytes from one line to the next.
    pub line_bytes: usize,
}

impl Device {
    /// Opens a device that has one of the formats in the size; the first that it grants.
    ///
    /// # Errors
    /// There is no such device, it is taken, or it grants another size or format only.
    pub fn open(
        path: &Path,
        ImageSize { width, height }: ImageSize,
        formats: &[[u8; 4]],
    ) -> io::Result<Self> {
        let side = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        let mut granted = Vec::new();
        for format in formats {
            let wanted = PixFormat::new(side(width), side(height), PixelFormat::from_fourcc(*format));
            let capture = linuxvideo::Device::open(path)?.video_capture(wanted)?;
            let found = capture.format();
            let is_wanted = found.pixel_format().as_fourcc() == *format
                && (found.width(), found.height()) == (side(width), side(height));
            if is_wanted {
                let line_bytes = found.bytes_per_line() as usize;
                return Ok(Self { stream: capture.into_stream()?, format: *format, line_bytes });
            }
            granted.push(format!("{} {} × {}", found.pixel_format(), found.width(), found.height()));
        }
        Err(io::Error::new(
            io::ErrorKind::Unsupported,
            format!("{} grants only {}", path.display(), granted.join(", ")),
        ))
    }

    /// The newest frame that waits, stamped now: older ones are thrown away. `None` where none waits or the driver says
    /// that it is damaged.
    ///
    /// # Errors
    /// The device is gone.
    pub fn newest(&mut self) -> io::Result<Option<(Stamp, Vec<u8>)>> {
        /// More than the kernel keeps for us.
        const WAITING_MAX: usize = 8;
        let mut newest = None;
        for _ in 0..WAITING_MAX {
            if self.stream.will_block()? {
                break;
            }
            newest = self.stream.dequeue(|frame| Ok((!frame.is_error()).then(|| frame.to_vec())))?;
        }
        Ok(newest.map(|bytes| (clock::now(), bytes)))
    }
}
