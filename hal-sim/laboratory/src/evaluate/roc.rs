//! How well scores separate two classes, whatever threshold one chooses.

/// Area under the curve of hits over false alarms; equal scores count half. 0.5 where one class is missing.
#[must_use]
pub fn area_under_curve(pairs: &mut [(f32, bool)]) -> f64 {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let positives = pairs.iter().filter(|(_, is_true)| *is_true).count() as f64;
    let negatives = pairs.len() as f64 - positives;
    if positives == 0.0 || negatives == 0.0 {
        return 0.5;
    }
    // Mann and Whitney: for every positive the negatives below it, and half of those that are equal.
    let (mut below, mut area) = (0.0, 0.0);
    for equal in pairs.chunk_by(|a, b| a.0 == b.0) {
        let own = equal.iter().filter(|(_, is_true)| *is_true).count() as f64;
        let other = equal.len() as f64 - own;
        area += own * (below + 0.5 * other);
        below += other;
    }
    area / (positives * negatives)
}

/// Largest intersection over union of "score at least t" with the truth, over all t; 0 without a positive.
#[must_use]
pub fn best_overlap(pairs: &mut [(f32, bool)]) -> f64 {
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let positives = pairs.iter().filter(|(_, is_true)| *is_true).count();
    let (mut called, mut hits, mut best) = (0, 0, 0.0_f64);
    for equal in pairs.chunk_by(|a, b| a.0 == b.0) {
        called += equal.len();
        hits += equal.iter().filter(|(_, is_true)| *is_true).count();
        let union = called + positives - hits;
        best = best.max(hits as f64 / union.max(1) as f64);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let mut pairs = [(0.1, false), (0.4, false), (0.35, true), (0.8, true)];
        assert_eq!(area_under_curve(&mut pairs), 0.75);
        assert_eq!(best_overlap(&mut pairs), 2.0 / 3.0);
        let mut equal = [(1.0, true), (1.0, false), (1.0, false)];
        assert_eq!(area_under_curve(&mut equal), 0.5);
        assert_eq!(best_overlap(&mut equal), 1.0 / 3.0);
        assert_eq!(area_under_curve(&mut [(1.0, false)]), 0.5);
        assert_eq!(best_overlap(&mut []), 0.0);
    }
}
