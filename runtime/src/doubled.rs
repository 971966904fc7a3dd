//! Values that are kept twice, so that a flipped bit in one of them is noticed before it is used (FG-REQ-058).

/// A value and its copy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Doubled<T> {
    pub(crate) value: T,
    pub(crate) copy: T,
}

impl<T: Copy + PartialEq> Doubled<T> {
    /// Both are this value.
    pub(crate) const fn new(value: T) -> Self {
        Self { value, copy: value }
    }

    /// From now on both are this value.
    pub(crate) fn set(&mut self, value: T) {
        *self = Self::new(value);
    }

    /// The value; `None` when the two differ, or are no numbers.
    pub(crate) fn get(&self) -> Option<T> {
        (self.value == self.copy).then_some(self.value)
    }
}
