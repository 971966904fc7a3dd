//! Lines of text out of bytes.

/// What has come of a line so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines(Vec<u8>);

impl Lines {
    /// The whole lines that end with these bytes.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<String> {
        let mut lines = Vec::new();
        for byte in bytes {
            if matches!(byte, b'\r' | b'\n') {
                let line = core::mem::take(&mut self.0);
                lines.extend(String::from_utf8(line).ok().filter(|line| !line.is_empty()));
            } else {
                self.0.push(*byte);
            }
        }
        lines
    }
}
