//! Counts as people say them.

/// `1 stop`, `2 stops`, `2 switches`; the plural of `person` is `people`.
#[must_use]
pub fn counted(count: impl Into<u64>, what: &str) -> String {
    let count = count.into();
    match (count, what) {
        (1, _) => format!("1 {what}"),
        (_, "person") => format!("{count} people"),
        _ if what.ends_with("ch") => format!("{count} {what}es"),
        _ => format!("{count} {what}s"),
    }
}

/// What stands beside a figure: `stop` beside 1, `stops` beside every other.
#[must_use]
pub fn beside(count: impl Into<u64>, one: &'static str, many: &'static str) -> &'static str {
    if count.into() == 1 { one } else { many }
}

#[cfg(test)]
mod tests {
    use super::{beside, counted};

    #[test]
    fn one_is_not_many() {
        assert_eq!(counted(1_u32, "stop"), "1 stop");
        assert_eq!(counted(0_u32, "stop"), "0 stops");
        assert_eq!([counted(1_u64, "person"), counted(2_u64, "person")], ["1 person", "2 people"]);
        assert_eq!([counted(1_u32, "switch"), counted(2_u32, "switch")], ["1 switch", "2 switches"]);
        assert_eq!([0_u32, 1, 2].map(|count| beside(count, "stop", "stops")), ["stops", "stop", "stops"]);
    }
}
