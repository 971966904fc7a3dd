//! LZF, the compression of PCD files (Lehmann's LibLZF).

/// The `plain` bytes that were packed; `None` where the packed bytes are damaged.
pub fn unpack(packed: &[u8], plain: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(plain.min(packed.len().saturating_mul(264)));
    let mut rest = packed;
    while let Some((control, after)) = rest.split_first() {
        rest = after;
        let control = usize::from(*control);
        if control < 32 {
            let (literal, after) = rest.split_at_checked(control + 1)?;
            out.extend(literal);
            rest = after;
            continue;
        }
        let mut length = control >> 5;
        if length == 7 {
            let (more, after) = rest.split_first()?;
            length += usize::from(*more);
            rest = after;
        }
        let (low, after) = rest.split_first()?;
        rest = after;
        let back = ((control & 31) << 8) + usize::from(*low) + 1;
        let from = out.len().checked_sub(back)?;
        for index in from..from + length + 2 {
            let byte = *out.get(index)?;
            out.push(byte);
        }
        if out.len() > plain {
            return None;
        }
    }
    (out.len() == plain).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Packed by hand after the format: three literals, then seven bytes from three back.
    #[test]
    fn literals_and_repeats_unpack() {
        let packed = [2, b'a', b'b', b'c', 5 << 5, 2];
        assert_eq!(unpack(&packed, 10).as_deref(), Some(&b"abcabcabca"[..]));
        assert_eq!(unpack(&packed, 9), None);
        for cut in 1..packed.len() {
            assert_eq!(unpack(&packed[..cut], 10), None, "cut at {cut}");
        }
        assert_eq!(unpack(&[32, 9], 3), None, "before the beginning");
    }
}
