//! The wire format of Protocol Buffers, as much of it as annotations need.
//!
//! Source: Protocol Buffers, encoding: a tag (field number · 8 + kind), then a variable-length number (kind 0), eight octets
//! (1), a length and octets (2), or four octets (5).

/// One field of a message.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Its number.
    pub number: u64,
    /// Its value, for kinds 0, 1 and 5.
    pub value: u64,
    /// Its octets, for kind 2.
    pub bytes: Option<&'a [u8]>,
}

/// The fields of a message; `None` once it is damaged.
pub struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    /// Of a message.
    pub const fn of(message: &'a [u8]) -> Self {
        Self { rest: message }
    }

    fn variable(&mut self) -> Option<u64> {
        let mut value = 0_u64;
        for index in 0..10_u32 {
            let (octet, rest) = self.rest.split_first()?;
            self.rest = rest;
            value |= u64::from(octet & 0x7F).checked_shl(7 * index)?;
            if octet & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn octets(&mut self, count: u64) -> Option<&'a [u8]> {
        let (octets, rest) = self.rest.split_at_checked(usize::try_from(count).ok()?)?;
        self.rest = rest;
        Some(octets)
    }

    fn field(&mut self) -> Option<Field<'a>> {
        let tag = self.variable()?;
        let number = tag >> 3;
        let plain = |value| Some(Field { number, value, bytes: None });
        match tag & 7 {
            0 => plain(self.variable()?),
            1 => plain(u64::from_le_bytes(self.octets(8)?.try_into().ok()?)),
            2 => {
                let length = self.variable()?;
                Some(Field { number, value: 0, bytes: Some(self.octets(length)?) })
            }
            5 => plain(u64::from(u32::from_le_bytes(self.octets(4)?.try_into().ok()?))),
            _ => None,
        }
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Option<Field<'a>>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_none() {
            self.rest = &[];
        }
        Some(field)
    }
}

/// The number in a field of a message.
pub fn number(message: &[u8], wanted: u64) -> Option<u64> {
    Fields::of(message).flatten().find(|field| field.number == wanted).map(|field| field.value)
}

/// Fields 1 and 2 as doubles; a field that is left out is 0. `None` if the message is damaged.
pub fn pair(message: &[u8]) -> Option<[f64; 2]> {
    let mut pair = [0.0; 2];
    for field in Fields::of(message) {
        let field = field?;
        match field.number {
            1 => pair[0] = f64::from_bits(field.value),
            2 => pair[1] = f64::from_bits(field.value),
            _ => {}
        }
    }
    Some(pair)
}
