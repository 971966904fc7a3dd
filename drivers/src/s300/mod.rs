//! SICK S300 (and S3000): the continuous data output of its RS-422 line. Source: book, SICK S300.
//!
//! The interface needs no command: the scanner talks, the host listens. Safety must not depend on this line alone;
//! the scanner's own switching outputs are the safety channel.

mod configuration;
mod receiver;
mod telegram;

pub use configuration::{Bit13, Configuration};
pub use receiver::{Counters, Event, EventOf, Receiver, ReceiverOf};
pub use telegram::{Telegram, TelegramError};

#[cfg(test)]
mod vector_tests;
