//! SICK TiM5xx and LMS1xx: scans in text telegrams over TCP (book, CoLa A).
//!
//! ```
//! use floorguard_drivers::cola::{Cola, TIM5XX};
//! use floorguard_drivers::ranging::RangingScanner;
//! use floorguard_types::time::Stamp;
//!
//! let mut scanner = Cola::new(TIM5XX);
//! let mut sent = Vec::new();
//! scanner.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes), &mut |_| {});
//! assert_eq!(sent, b"\x02sEN LMDscandata 1\x03");
//! ```

mod scanner;
mod telegram;

pub use scanner::{Cola, ColaConfiguration, ColaOf, LMS1XX, TIM5XX};
pub use telegram::{ScanTelegram, TELEGRAM_BYTES, TelegramError};

#[cfg(test)]
mod scanner_tests;
