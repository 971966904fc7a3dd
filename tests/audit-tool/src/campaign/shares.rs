//! Shares that a campaign is about, with their confidence intervals.

use std::collections::BTreeMap;

use crate::facts::facts;

/// Prints the shares of a campaign. How many lie beyond their limit by more than chance explains.
pub fn missed(campaign: &str, counts: &BTreeMap<String, u64>) -> usize {
    let mut missed = 0;
    for share in facts().share.iter().filter(|share| share.campaign == campaign) {
        let count = |name: &str| counts.get(name).copied().unwrap_or(0);
        let (part, whole) = (count(&share.part), count(&share.whole));
        let (low, high) = wilson95(part, whole);
        let (word, limit, proven, refuted) = match (share.at_most, share.at_least) {
            (Some(limit), _) => ("at most", limit, high <= limit, low > limit),
            (None, limit) => {
                let limit = limit.unwrap_or(1.0);
                ("at least", limit, low >= limit, high < limit)
            }
        };
        let verdict = match (proven, refuted) {
            (true, _) => "shown",
            (_, true) => "MISSED",
            _ => "too few trials to tell",
        };
        let percent = |share: f64| 100.0 * share;
        println!(
            "  {} {part} of {whole} = {:.3} % (95 %: {:.3}–{:.3} %); {word} {:.1} %: {verdict}",
            share.part,
            percent(part as f64 / whole.max(1) as f64),
            percent(low),
            percent(high),
            percent(limit),
        );
        missed += usize::from(refuted);
    }
    missed
}

/// Wilson 95 % interval of a share. No observations: everything is possible.
fn wilson95(part: u64, whole: u64) -> (f64, f64) {
    if whole == 0 {
        return (0.0, 1.0);
    }
    let (k, n, z) = (part as f64, whole as f64, 1.959_964);
    let share = k / n;
    let middle = share + z * z / (2.0 * n);
    let spread = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    (((middle - spread) / scale).max(0.0), ((middle + spread) / scale).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_beyond_chance_fails() {
        let counts = |falsely| {
            [("falsely with faults", falsely), ("claimed with faults", 10_000)]
                .into_iter()
                .map(|(name, count)| (name.to_owned(), count))
                .collect::<BTreeMap<_, _>>()
        };
        assert_eq!(missed("claims", &counts(20)), 0);
        assert_eq!(missed("claims", &counts(200)), 1);
        assert_eq!(missed("another", &counts(200)), 0);
    }
}
