//! Fields at fixed places of a frame.

/// The bytes at an offset; 0 beyond the end.
pub(crate) fn bytes_at<const N: usize>(bytes: &[u8], at: u8) -> [u8; N] {
    bytes.get(usize::from(at)..).and_then(<[u8]>::first_chunk::<N>).copied().unwrap_or([0; N])
}
