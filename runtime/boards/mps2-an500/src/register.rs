//! One memory-mapped register.

/// A 32-bit device register.
///
/// Invariant: `address` is a register of a device that the board's manual lists (platform notes, 2.1), aligned to
/// four bytes. Only constants of this crate create one.
#[derive(Clone, Copy)]
pub struct Register(usize);

impl Register {
    /// The register at `address`.
    pub const fn at(address: usize) -> Self {
        Self(address)
    }

    /// Reads it.
    pub fn read(self) -> u32 {
        // SAFETY: by the invariant of the type, the address is a readable, aligned device register.
        unsafe { core::ptr::with_exposed_provenance::<u32>(self.0).read_volatile() }
    }

    /// Writes it.
    pub fn write(self, value: u32) {
        // SAFETY: by the invariant of the type, the address is a writable, aligned device register.
        unsafe { core::ptr::with_exposed_provenance_mut::<u32>(self.0).write_volatile(value) }
    }

    #[allow(dead_code, reason = "the images share this file, one of them only reads and writes")]
    /// Sets and clears bits; callers hold a critical section where an interrupt writes the same register.
    pub fn modify(self, clear: u32, set: u32) {
        self.write(self.read() & !clear | set);
    }
}
