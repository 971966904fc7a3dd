//! CoLa A and B as a SICK TiM or LMS sends them (book, CoLa).

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

/// A binary telegram with its frame.
#[must_use]
pub fn cola_binary(content: &[u8]) -> Vec<u8> {
    let check = content.iter().fold(0, |check, byte| check ^ byte);
    [&[2, 2, 2, 2][..], &(content.len() as u32).to_be_bytes(), content, &[check]].concat()
}

/// The same scan as [`cola_scan`] in CoLa B; the high byte comes first.
#[must_use]
pub fn cola_scan_binary(header: &ColaHeader, distances_mm: &[u32]) -> Vec<u8> {
    let ColaHeader { status, scan, clock_us, turns_chz, angles: (first, step) } = header;
    let mut content = b"sSN LMDscandata ".to_vec();
    content.extend([0, 1, 0, 1, 0, 0x89, 0xA2, 0x7F]);
    for short in [*status, *scan, *scan] {
        content.extend(short.to_be_bytes());
    }
    for number in clock_us {
        content.extend(number.to_be_bytes());
    }
    content.extend([0, 0, 7, 0, 0, 0]);
    content.extend(turns_chz.to_be_bytes());
    content.extend(0xA2_u32.to_be_bytes());
    content.extend([0, 0, 0, 1]);
    content.extend(b"DIST1");
    content.extend([0x3F, 0x80, 0, 0, 0, 0, 0, 0]);
    content.extend(first.to_be_bytes());
    content.extend(step.to_be_bytes());
    content.extend((distances_mm.len() as u16).to_be_bytes());
    content.extend(distances_mm.iter().flat_map(|distance| (*distance as u16).to_be_bytes()));
    content.extend([0; 12]);
    cola_binary(&content)
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

    /// The beginning of the binary one; its telegrams are counted as its scans here.
    #[test]
    fn binary_scans_equal_the_printed_one() {
        let header = ColaHeader {
            status: 0,
            scan: 0x347,
            clock_us: [0x2747_7BA9, 0x2747_813B],
            turns_chz: 5_000,
            angles: (100_000, 5_000),
        };
        let bytes = cola_scan_binary(&header, &[0x893, 0x895]);
        let printed = b"\0\x01\0\x01\0\x89\xA2\x7F\0\0\x03\x47\x03\x47\x27\x47\x7B\xA9\x27\x47\x81\x3B\0\0\x07\0\0\0\0\0\x13\x88";
        assert_eq!(bytes[24..24 + printed.len()], printed[..]);
        let behind = b"\0\0\0\x01DIST1\x3F\x80\0\0\0\0\0\0\0\x01\x86\xA0\x13\x88\0\x02\x08\x93\x08\x95\0";
        assert_eq!(bytes[24 + printed.len() + 4..][..behind.len()], behind[..]);
        assert_eq!(cola_binary(b"sEN LMDscandata \x01").last(), Some(&0x33));
    }
}
