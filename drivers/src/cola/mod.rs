//! CoLa A, in which SICK's TiM5xx and LMS1xx send their scans as text (book, CoLa A).

mod telegram;

pub use telegram::{ScanTelegram, TELEGRAM_BYTES, TelegramError};
