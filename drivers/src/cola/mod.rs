//! CoLa A and B, in which SICK's TiM5xx and LMS1xx send their scans as text or binary (book, CoLa).

mod binary;
mod framer;
mod telegram;

pub use framer::{Frame, Framer};
pub use telegram::{ScanTelegram, TELEGRAM_BYTES, TelegramError};

#[cfg(test)]
mod binary_tests;
