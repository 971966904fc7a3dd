//! What the guard says, piece by piece: words of the table with a gap for a number or for other words, so that a page can say it in
//! any language.

use floorguard_guard::{CauseRecord, Health, ResetRefusal, Unit};
use serde::Serialize;

use crate::words::Language;

/// A piece; pieces are joined by commas.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Piece {
    /// Words of the table; `{}` stands for the number, or for the other words.
    pub key: String,
    /// Words for the gap, of the table too.
    pub word: Option<String>,
    /// Text for the gap that is the same in all languages.
    pub text: Option<String>,
    /// Number for the gap.
    pub number: Option<f64>,
    /// Digits behind its point.
    pub digits: usize,
    /// Its unit.
    pub unit: &'static str,
}

impl Piece {
    fn words(key: impl ToString) -> Self {
        Self { key: key.to_string(), ..Self::default() }
    }

    fn number(key: &str, number: f64, (digits, unit): (usize, &'static str)) -> Self {
        Self { number: Some(number), digits, unit, ..Self::words(key) }
    }
}

/// Pieces in a language, as the page says them.
pub fn spoken(pieces: &[Piece], language: Language) -> String {
    let phrases = pieces.iter().map(|piece| match (piece.number, &piece.word, &piece.text) {
        (Some(value), ..) => {
            let value = language.number(value, piece.digits);
            language.fill(&piece.key, &[&format!("{value} {}", piece.unit)])
        }
        (None, Some(word), _) => language.fill(&piece.key, &[language.say(word)]),
        (None, None, Some(text)) => language.fill(&piece.key, &[text]),
        (None, None, None) => language.say(&piece.key).to_owned(),
    });
    phrases.collect::<Vec<_>>().join(", ")
}

/// Of a cause: its name, what was measured, the limit, the age, and what it demands.
pub fn of_cause(record: &CauseRecord) -> Vec<Piece> {
    let mut pieces = vec![Piece::words(record.cause)];
    if record.health != Health::Healthy {
        pieces.push(Piece::words(record.health));
    }
    let unit = match record.unit {
        Unit::None | Unit::Code => None,
        Unit::Metres => Some("m"),
        Unit::MetresPerSecond => Some("m/s"),
        Unit::RadiansPerSecond => Some("rad/s"),
        Unit::Seconds => Some("s"),
        Unit::Percent => Some("%"),
    };
    if let Some(unit) = unit {
        pieces.push(Piece::number("measured: {}", record.measured.into(), (2, unit)));
        pieces.push(Piece::number("limit: {}", record.limit.into(), (2, unit)));
    }
    if record.unit == Unit::Code {
        let text = Some(format!("{:#06x}", record.measured as u32));
        pieces.push(Piece { text, ..Piece::words("code {}") });
    }
    if record.ahead_us > 0 {
        let ahead_s = record.ahead_us as f64 * 1.0e-6;
        pieces.push(Piece::number(
            "stamped {} in the future: its clock and the robot's differ",
            ahead_s,
            (3, "s"),
        ));
    }
    if record.age_us > 0 && record.age_us < u64::MAX {
        pieces.push(Piece::number("{} old", (record.age_us / 1_000) as f64, (0, "ms")));
    }
    pieces.push(Piece::words(record.action));
    pieces
}

/// Of a reset that was refused: why, and what helps.
pub fn of_refusal(refusal: Option<ResetRefusal>, remedy: &str) -> Vec<Piece> {
    let mut pieces = match refusal {
        Some(ResetRefusal::Present(cause)) => {
            vec![Piece { word: Some(cause.to_string()), ..Piece::words("still there: {}") }]
        }
        Some(ResetRefusal::NotHealthy(source, health)) => {
            vec![Piece::words(source.name()), Piece::words(health)]
        }
        Some(ResetRefusal::Moving) => vec![Piece::words("the robot still moves")],
        None => Vec::new(),
    };
    if !remedy.is_empty() {
        pieces.push(Piece::words(remedy));
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_guard::{Cause, Source};
    use floorguard_types::time::Stamp;

    fn keys(pieces: &[Piece]) -> Vec<&str> {
        pieces.iter().map(|piece| piece.key.as_str()).collect()
    }

    /// Each number that the English line of a cause shows is a piece of its own.
    #[test]
    fn pieces_hold_what_the_line_holds() {
        let record = CauseRecord::new(Cause::ScanProtective, Stamp::ZERO).metres(0.8, 1.2).aged(45_000);
        let pieces = of_cause(&record);
        let action = record.action.to_string();
        let expected = [
            "obstacle in the protective field (safety scanner)",
            "measured: {}",
            "limit: {}",
            "{} old",
            &action,
        ];
        assert_eq!(keys(&pieces), expected);
        let numbers: Vec<f64> = pieces.iter().filter_map(|piece| piece.number).collect();
        assert!((numbers[0] - 0.8).abs() < 1.0e-6 && numbers[2] == 45.0, "{numbers:?}");
        for piece in pieces.iter().filter(|piece| piece.number.is_some()) {
            let shown = format!("{:.*} {}", piece.digits, piece.number.unwrap_or_default(), piece.unit);
            assert!(record.to_string().contains(&shown), "{shown}: {record}");
        }
        let german =
            "Hindernis im Schutzfeld (Sicherheitsscanner), gemessen: 0,80 m, Grenze: 1,20 m, 45 ms alt, ";
        assert!(
            spoken(&pieces, Language::German).starts_with(german),
            "{}",
            spoken(&pieces, Language::German)
        );
        let code = CauseRecord::new(Cause::DriveFault, Stamp::ZERO).measured(21_569.0, 0.0, Unit::Code);
        assert_eq!(of_cause(&code)[1].text.as_deref(), Some("0x5441"));
    }

    #[test]
    fn refusals_name_their_reason() {
        let present = of_refusal(Some(ResetRefusal::Present(Cause::DriveFault)), "Try again.");
        assert_eq!(present[0].word.as_deref(), Some("drive reports a fault"));
        assert_eq!(keys(&present), ["still there: {}", "Try again."]);
        let ill = of_refusal(Some(ResetRefusal::NotHealthy(Source::Lidar, Health::Stale)), "");
        assert_eq!(keys(&ill), ["lidar", "stale"]);
        assert_eq!(keys(&of_refusal(Some(ResetRefusal::Moving), "")), ["the robot still moves"]);
    }
}
