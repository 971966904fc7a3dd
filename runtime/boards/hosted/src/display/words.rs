//! Counts as people say them.

/// `1 stop`, `2 stops`; the plural of `person` is `people`.
#[must_use]
pub fn counted(count: impl Into<u64>, what: &str) -> String {
    let count = count.into();
    match (count, what) {
        (1, _) => format!("1 {what}"),
        (_, "person") => format!("{count} people"),
        _ => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_not_many() {
        assert_eq!(counted(1_u32, "stop"), "1 stop");
        assert_eq!(counted(0_u32, "stop"), "0 stops");
        assert_eq!([counted(1_u64, "person"), counted(2_u64, "person")], ["1 person", "2 people"]);
    }
}
