//! SCIP 2.0 as a Hokuyo sensor sends it (book, SCIP 2.0).

/// A number as characters of six bits each, the highest first.
#[must_use]
pub fn scip_number(number: u32, characters: u32) -> String {
    (0..characters).rev().map(|place| char::from(((number >> (6 * place)) % 64) as u8 + b'0')).collect()
}

/// The check character of a line.
fn check(content: &str) -> char {
    char::from((content.bytes().map(u32::from).sum::<u32>() % 64) as u8 + b'0')
}

/// A line with its check character; a semicolon before it where lines of text have one.
#[must_use]
pub fn scip_line(content: &str, separator: &str) -> String {
    format!("{content}{separator}{}\n", check(content))
}

/// A reply: echo, status, lines that are finished already, and the empty line.
#[must_use]
pub fn scip_reply(echo: &str, status: &str, lines: &[String]) -> Vec<u8> {
    format!("{echo}\n{}{}\n", scip_line(status, ""), lines.concat()).into_bytes()
}

/// A reply with a scan: the sensor's counter of milliseconds, and values of two or three characters in blocks of 64.
#[must_use]
pub fn scip_scan(echo: &str, status: &str, (sensor_ms, values): (u32, &[u32]), characters: u32) -> Vec<u8> {
    let data: String = values.iter().map(|value| scip_number(*value, characters)).collect();
    let blocks = data.as_bytes().chunks(64).map(|block| scip_line(&String::from_utf8_lossy(block), ""));
    let mut lines = vec![scip_line(&scip_number(sensor_ms, 4), "")];
    lines.extend(blocks);
    scip_reply(echo, status, &lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the specification: sections 6.1 to 6.3, the sum of "Hokuyo", and lines of section 8.12.
    #[test]
    fn encodings_equal_the_published_ones() {
        assert_eq!(scip_number(1_234, 2), "CB");
        assert_eq!(scip_number(5_432, 3), "1Dh");
        assert_eq!(scip_number(16_000_000, 4), "m2@0");
        assert_eq!(scip_line("Hokuyo", ""), "Hokuyoo\n");
        for printed in
            ["DMIN:20;4\n", "DMAX:5600;_\n", "AMIN:44;7\n", "AMAX:725;o\n", "AFRT:384;6\n", "SCAN:600;e\n"]
        {
            let content = printed.split(';').next().unwrap();
            assert_eq!(scip_line(content, ";"), printed);
        }
        assert_eq!(scip_reply("QT", "00", &[]), b"QT\n00P\n\n");
        assert!(
            scip_scan("MD0000000101000", "99", (0, &[20, 30]), 3)
                .starts_with(b"MD0000000101000\n99b\n00000\n00D00N")
        );
    }
}
