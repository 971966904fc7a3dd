//! CoLa A as a SICK TiM or LMS sends it (book, CoLa A).

/// What stands in the head of a telegram of scan data.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColaHeader {
    /// What the sensor says of itself.
    pub status: u16,
    /// Counts scans.
    pub scan: u16,
    /// Microseconds since it was switched on: at the beginning of the turn, and when the telegram is sent.
    pub clock_us: [u32; 2],
    /// Turns a second, hundredths.
    pub turns_chz: u32,
    /// Angle of the first distance and step, ten-thousandths of a degree; 90° is straight ahead.
    pub angles: (i32, u16),
}

/// A telegram with its start and end byte.
#[must_use]
pub fn cola_telegram(text: &str) -> Vec<u8> {
    [b"\x02", text.as_bytes(), b"\x03"].concat()
}

/// A scan: millimetres, 0 for no return.
#[must_use]
pub fn cola_scan(header: &ColaHeader, distances_mm: &[u32]) -> Vec<u8> {
    let ColaHeader { status, scan, clock_us: [begun, sent], turns_chz, angles: (first, step) } = header;
    let data: Vec<String> = distances_mm.iter().map(|distance| format!("{distance:X}")).collect();
    cola_telegram(&format!(
        "sSN LMDscandata 1 1 89A27F 0 {status:X} {scan:X} {scan:X} {begun:X} {sent:X} 0 0 7 0 0 {turns_chz:X} A2 0 1 DIST1 3F800000 \
         00000000 {first:X} {step:X} {:X} {} 0 0 0 0 0 0",
        distances_mm.len(),
        data.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The printed example of the maker's listing, but for its counter of telegrams.
    #[test]
    fn scans_equal_the_printed_one() {
        let header = ColaHeader {
            status: 0,
            scan: 0x347,
            clock_us: [0x2747_7BA9, 0x2747_813B],
            turns_chz: 1_500,
            angles: (-50_000, 5_000),
        };
        let bytes = cola_scan(&header, &[0x8A1, 0x8A5]);
        let printed = "\x02sSN LMDscandata 1 1 89A27F 0 0 347 347 27477BA9 2747813B 0 0 7 0 0 5DC A2 0 1 DIST1 3F800000 00000000 \
                       FFFF3CB0 1388 2 8A1 8A5 0 0 0 0 0 0\x03";
        assert_eq!(String::from_utf8(bytes).unwrap(), printed);
    }
}
