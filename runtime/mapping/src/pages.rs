//! Large storage that comes and goes while a map grows.

use memmap2::MmapMut;

/// Bytes in pages of their own, 0 at first; the system has them back as soon as they are dropped. Between what stays for long the heap
/// would keep a gap of their size.
pub enum Pages {
    /// Pages of the system.
    Own(MmapMut),
    /// Where it gives none.
    Heap(Box<[u8]>),
}

impl Pages {
    /// So many bytes.
    #[must_use]
    pub fn new(bytes: usize) -> Self {
        MmapMut::map_anon(bytes).map_or_else(|_| Self::Heap(vec![0; bytes].into_boxed_slice()), Self::Own)
    }
}

impl AsRef<[u8]> for Pages {
    fn as_ref(&self) -> &[u8] {
        match self {
            Self::Own(pages) => pages,
            Self::Heap(bytes) => bytes,
        }
    }
}

impl AsMut<[u8]> for Pages {
    fn as_mut(&mut self) -> &mut [u8] {
        match self {
            Self::Own(pages) => pages,
            Self::Heap(bytes) => bytes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_begin_empty() {
        for bytes in [0, 1, 5_000] {
            let mut pages = Pages::new(bytes);
            assert_eq!(pages.as_ref(), vec![0; bytes]);
            pages.as_mut().fill(7);
            assert_eq!(pages.as_ref(), vec![7; bytes]);
        }
    }
}
