//! The steps that bring a device to measure (book, VectorNav: Start-up), with their requests, answers and patience.

use super::line::hexadecimal;

/// How far the start-up is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DevicePhase {
    /// Asked to be quiet: samples would delay the answers.
    #[default]
    Silencing,
    /// Asked who it is.
    Naming,
    /// Its text output is switched off.
    Muting,
    /// Its first binary output is set.
    Configuring,
    /// Asked to send.
    Resuming,
    /// Measures.
    Measuring,
    /// It is the wrong device or rejects its configuration; asked again after a pause.
    Refused,
}

/// Samples per second that are asked for.
pub(super) const RATE_HZ: u64 = 100;
/// An answer that is later than this is asked for again, microseconds.
const ANSWER_US: u64 = 200_000;
/// A refused device is asked again after this: it may have been replaced.
const REFUSED_US: u64 = 5_000_000;
/// A step asks this often.
const TRIES: u8 = 5;

/// Which rate of its own a device divides: 800 or 400 samples a second (book, VectorNav: Start-up).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Series {
    /// VN-100 and VN-110.
    #[default]
    Vn100,
    /// VN-200, VN-300 and their kin.
    Vn200,
}

impl Series {
    /// By the words of the model register.
    pub fn of(name: &[u8]) -> Option<Self> {
        match name {
            [b'V', b'N', b'-', b'1', ..] => Some(Self::Vn100),
            [b'V', b'N', b'-', b'2' | b'3', ..] => Some(Self::Vn200),
            _ => None,
        }
    }

    /// The write of the register of the first binary output: both ports, divisor, groups, fields.
    const fn configuration(self) -> &'static [u8] {
        match self {
            Self::Vn100 => b"VNWRG,75,3,8,05,0121,0800",
            Self::Vn200 => b"VNWRG,75,3,4,05,0121,0800",
        }
    }
}

impl DevicePhase {
    /// How long the step waits for its answer, microseconds, and how often it asks.
    pub(super) const fn patience(self) -> (u64, u8) {
        match self {
            Self::Refused => (REFUSED_US, 1),
            _ => (ANSWER_US, TRIES),
        }
    }

    /// What the step sends.
    pub(super) const fn request(self, series: Series) -> Option<&'static [u8]> {
        match self {
            Self::Silencing => Some(b"VNASY,0"),
            Self::Naming => Some(b"VNRRG,1"),
            Self::Muting => Some(b"VNWRG,6,0"),
            Self::Configuring => Some(series.configuration()),
            Self::Resuming => Some(b"VNASY,1"),
            Self::Measuring | Self::Refused => None,
        }
    }

    /// The step behind.
    pub(super) const fn next(self) -> Self {
        match self {
            Self::Silencing => Self::Naming,
            Self::Naming => Self::Muting,
            Self::Muting => Self::Configuring,
            Self::Configuring => Self::Resuming,
            Self::Resuming | Self::Measuring => Self::Measuring,
            Self::Refused => Self::Silencing,
        }
    }
}

/// How an answer agrees with what was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Echo {
    /// In every number.
    Same,
    /// The same register with other numbers.
    Other,
    /// Another answer.
    Unrelated,
}

/// Devices write numbers with leading zeros of their own. Numbers are compared by their digits without them; the name of the command and
/// the first number, the register, say what is answered.
pub(super) fn compare(request: &[u8], answer: &[u8]) -> Echo {
    let words = |text| <[u8]>::split(text, |byte| *byte == b',').map(significant);
    let is_same_register = words(request).zip(words(answer)).take(2).filter(|(a, b)| a == b).count() == 2;
    match (is_same_register, words(request).eq(words(answer))) {
        (false, _) => Echo::Unrelated,
        (true, true) => Echo::Same,
        (true, false) => Echo::Other,
    }
}

/// Without leading zeros; a zero alone stays nothing.
fn significant(word: &[u8]) -> &[u8] {
    let zeros = word.iter().take_while(|byte| **byte == b'0').count();
    word.get(zeros..).unwrap_or_default()
}

/// The model in the answer to the question for it.
pub(super) fn model(answer: &[u8]) -> Option<&[u8]> {
    let name = answer.strip_prefix(b"VNRRG,")?;
    name.strip_prefix(b"01,").or_else(|| name.strip_prefix(b"1,"))
}

/// The code of an error report: decimal or hexadecimal digits, by the firmware.
pub(super) fn error_code(words: &[u8]) -> Option<u8> {
    let digits = words.strip_prefix(b"VNERR,")?;
    u8::try_from(hexadecimal(digits)?).ok()
}
