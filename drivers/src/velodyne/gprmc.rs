//! The sentence of a satellite receiver, as the lidar passes it on: `$GPRMC`, NMEA 0183.
//!
//! A lidar without a receiver sends one too, beginning at 2000-01-01, and week numbers roll over: the date is not
//! given at all, and nothing may be used unless [`Gprmc::is_valid`] and the PPS is locked (book, Velodyne: Position
//! packet).

use floorguard_types::number::nearest_f64;

/// Time of day and place.
///
/// ```
/// use floorguard_drivers::velodyne::Gprmc;
///
/// let sentence = "$GPRMC,225446,V,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E*7F";
/// let found = Gprmc::parse(sentence).unwrap();
/// assert!(!found.is_valid, "V: the receiver itself does not trust it");
/// assert_eq!(found.seconds_of_day, (22 * 60 + 54) * 60 + 46);
/// assert!(Gprmc::parse("$GPRMC,225446,A*00").is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gprmc {
    /// The receiver's own judgement: letter A.
    pub is_valid: bool,
    /// Whole seconds since midnight, UTC.
    pub seconds_of_day: u32,
    /// Where; none while the receiver leaves the fields empty.
    pub place: Option<Place>,
}

/// A place on the globe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
}

/// Why a sentence gives nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GprmcError {
    /// It does not start with `$GPRMC,` or `$GNRMC,`.
    Other,
    /// The two digits behind the asterisk are missing or contradict the characters.
    Checksum {
        /// Exclusive or of the characters.
        computed: u8,
    },
    /// A field is missing or out of its range; the number counts commas.
    Field(u8),
}

impl core::fmt::Display for GprmcError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Other => write!(f, "no RMC sentence"),
            Self::Checksum { computed } => write!(f, "RMC checksum is not {computed:02X}, as computed"),
            Self::Field(number) => write!(f, "RMC field {number} is missing or out of its range"),
        }
    }
}

impl core::error::Error for GprmcError {}

impl Gprmc {
    /// Reads a sentence without its line end.
    ///
    /// # Errors
    /// [`GprmcError`]; the sentence is not to be used.
    pub fn parse(sentence: &str) -> Result<Self, GprmcError> {
        let [b'$', sentence @ ..] = sentence.as_bytes() else { return Err(GprmcError::Other) };
        let [body, sum] = parts(sentence, b'*');
        let computed = body.iter().fold(0, |sum, byte| sum ^ byte);
        let length = body.len().saturating_add(1).saturating_add(sum.len());
        if length != sentence.len() || hexadecimal(sum) != Some(computed) {
            return Err(GprmcError::Checksum { computed });
        }
        let [name, time, validity, latitude, north, longitude, east] = parts(body, b',');
        if !matches!(name, b"GPRMC" | b"GNRMC") {
            return Err(GprmcError::Other);
        }
        let place = if latitude.is_empty() && longitude.is_empty() {
            None
        } else {
            Some(Place {
                latitude_deg: degrees(latitude, north, (b'N', b'S'), 90.0).ok_or(GprmcError::Field(3))?,
                longitude_deg: degrees(longitude, east, (b'E', b'W'), 180.0).ok_or(GprmcError::Field(5))?,
            })
        };
        let seconds_of_day = seconds_of_day(time).ok_or(GprmcError::Field(1))?;
        Ok(Self { is_valid: validity == b"A", seconds_of_day, place })
    }
}

/// What stands between the marks; what there is not is empty.
fn parts<const N: usize>(text: &[u8], mark: u8) -> [&[u8]; N] {
    let mut parts = [[].as_slice(); N];
    for (slot, part) in parts.iter_mut().zip(text.split(|byte| *byte == mark)) {
        *slot = part;
    }
    parts
}

/// Two digits of a sum.
fn hexadecimal(digits: &[u8]) -> Option<u8> {
    let &[high, low] = digits else { return None };
    let value = |digit: u8| char::from(digit).to_digit(16).and_then(|value| u8::try_from(value).ok());
    Some(value(high)? << 4 | value(low)?)
}

/// `hhmmss` with any fraction, which is dropped; a leap second counts.
fn seconds_of_day(time: &[u8]) -> Option<u32> {
    let &[h, hh, m, mm, s, ss, ..] = time else { return None };
    let two = |tens: u8, ones: u8, limit: u32| {
        let (tens, ones) = (char::from(tens).to_digit(10)?, char::from(ones).to_digit(10)?);
        Some(tens * 10 + ones).filter(|value| *value < limit)
    };
    Some(two(h, hh, 24)? * 3_600 + two(m, mm, 60)? * 60 + two(s, ss, 61)?)
}

/// Below this another digit fits, so that the whole number, of 15 digits at most, stays exact in a double.
const ONE_MORE_DIGIT: u64 = 100_000_000_000_000;

/// Digits with a point or without; `None` for a whole number of more than 15 digits. Up to 15 digits are correctly rounded, as the
/// quotient of two numbers that are exact; a fraction's further digits do not count. The library's reader can panic, as far as the
/// compiler knows.
fn decimal(text: &[u8]) -> Option<f64> {
    let [b'0'..=b'9', ..] = text else { return None };
    let (mut digits, mut scale, mut is_fraction) = (0_u64, 1.0, false);
    for byte in text {
        match byte {
            b'0'..=b'9' if digits < ONE_MORE_DIGIT => {
                digits = digits.saturating_mul(10).saturating_add(u64::from(byte & 0x0F));
                scale = if is_fraction { scale * 10.0 } else { scale };
            }
            // Cut off: less than one of the fifteenth digit.
            b'0'..=b'9' if is_fraction => {}
            b'.' if !is_fraction => is_fraction = true,
            _ => return None,
        }
    }
    Some(nearest_f64(digits) / scale)
}

/// `ddmm.mmm` or `dddmm.mmm` and its hemisphere.
fn degrees(value: &[u8], hemisphere: &[u8], (plus, minus): (u8, u8), limit_deg: f64) -> Option<f64> {
    let value = decimal(value)?;
    let whole = libm::floor(value / 100.0);
    let minutes = value - whole * 100.0;
    let degrees = whole + minutes / 60.0;
    let is_possible = (0.0..60.0).contains(&minutes) && (0.0..=limit_deg).contains(&degrees);
    match *hemisphere {
        _ if !is_possible => None,
        [letter] if letter == plus => Some(degrees),
        [letter] if letter == minus => Some(-degrees),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_without_a_fix_is_not_valid() {
        let parsed = Gprmc::parse("$GPRMC,225446,V,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E*7F");
        assert!(!parsed.expect("well-formed").is_valid);
    }

    fn parsed(fields: &str) -> Result<Gprmc, GprmcError> {
        let body = std::format!("GPRMC,{fields}");
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        Gprmc::parse(&std::format!("${body}*{sum:02X}"))
    }

    /// The last values that are possible, and the first ones that are not.
    #[test]
    fn limits_of_time_and_place() {
        assert_eq!(parsed("235960,A,,,,").map(|found| found.seconds_of_day), Ok(86_400), "a leap second");
        for time in ["240000", "236000", "235961", "2359"] {
            assert_eq!(parsed(&std::format!("{time},A,,,,")), Err(GprmcError::Field(1)), "{time}");
        }
        let place = |fields: &str| parsed(&std::format!("000000,A,{fields}")).map(|found| found.place);
        let pole = Place { latitude_deg: -90.0, longitude_deg: 180.0 };
        assert_eq!(place("9000.0,S,18000.0,E"), Ok(Some(pole)));
        let field = |number| Err(GprmcError::Field(number));
        assert_eq!(place("9000.1,N,00000.0,E"), field(3));
        assert_eq!(place("4960.0,N,00000.0,E"), field(3), "sixty minutes");
        assert_eq!(place("4900.0,N,18000.1,W"), field(5));
        assert_eq!(place(",,00000.0,E"), field(3), "half a place is none");
        assert_eq!(place("4900.0,N,,"), field(5));
    }

    #[test]
    fn numbers_are_read_to_the_bit() {
        for text in [
            "0",
            "4807.038",
            "01131.000",
            "4916.450000",
            "12311.123456789",
            "9000.0",
            "7.",
            "0000000000000004.5",
        ] {
            assert_eq!(decimal(text.as_bytes()), text.parse().ok(), "{text}");
        }
        let long = decimal(b"4916.45000000000000000000009").unwrap();
        assert!((long - 4916.45).abs() < 1.0e-9, "{long}");
        for text in ["", ".", ".5", "-1", "+1", "1e3", "1.2.3", "inf", "NaN", "1 ", "1000000000000000"] {
            assert_eq!(decimal(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn checksum_has_exactly_two_digits() {
        assert_eq!(hexadecimal(b"7f"), Some(0x7F));
        for text in ["7", "07F", "G0", "0G", ""] {
            assert_eq!(hexadecimal(text.as_bytes()), None, "{text}");
        }
        for text in ["$GPRMC,225446*64*", "$GPRMC,225446*64*0", "$GPRMC,225446"] {
            assert_eq!(Gprmc::parse(text), Err(GprmcError::Checksum { computed: 0x64 }), "{text}");
        }
    }

    #[test]
    fn wrong_sentences_say_what_is_wrong() {
        assert_eq!(Gprmc::parse(""), Err(GprmcError::Other));
        assert_eq!(Gprmc::parse("$GPGGA*56"), Err(GprmcError::Other));
        assert_eq!(Gprmc::parse("$GPRMC,225446*00"), Err(GprmcError::Checksum { computed: 0x64 }));
        assert_eq!(
            Gprmc::parse("$GPRMC,225446*64"),
            Ok(Gprmc { is_valid: false, seconds_of_day: 82_486, place: None })
        );
        let half = "$GPRMC,225446,A,4916.45,X,12311.12,W*3E";
        assert_eq!(Gprmc::parse(half), Err(GprmcError::Field(3)));
    }

    proptest::proptest! {
        #[test]
        fn any_text_gives_a_value_or_an_error(text in "\\PC{0,90}", body in "[0-9.,NSEWAV-]{0,60}") {
            let _ = Gprmc::parse(&text);
            let body = std::format!("GPRMC,{body}");
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            if let Ok(parsed) = Gprmc::parse(&std::format!("${body}*{sum:02X}")) {
                let inside = |place: Place| place.latitude_deg.abs() <= 90.0 && place.longitude_deg.abs() <= 180.0;
                proptest::prop_assert!(parsed.place.is_none_or(inside));
                proptest::prop_assert!(parsed.seconds_of_day <= 86_400);
            }
        }
    }
}
