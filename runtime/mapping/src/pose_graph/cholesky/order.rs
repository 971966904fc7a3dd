//! In which order the variables are eliminated.

/// The variables in an order that gives the factor few numbers: approximate minimum degree (Amestoy et al. 1996).
/// `lower` has, for each variable, the larger ones that share an equation with it, rising. Cost: nearly linear.
pub(super) fn fill_reducing_order(lower: &[Vec<usize>]) -> Vec<usize> {
    // Signed numbers: the routine marks what it has eliminated by the sign.
    let signed = |value: usize| i64::try_from(value).unwrap_or(i64::MAX);
    let mut starts = vec![0_i64];
    let mut rows = Vec::new();
    for list in lower {
        rows.extend(list.iter().map(|row| signed(*row)));
        starts.push(signed(rows.len()));
    }
    let answer = amd::order(signed(lower.len()), &starts, &rows, &amd::Control::default());
    let order = answer.ok().and_then(|(order, _, _)| {
        order.into_iter().map(|variable| usize::try_from(variable).ok()).collect::<Option<Vec<usize>>>()
    });
    order.filter(|order| order.len() == lower.len()).unwrap_or_else(|| (0..lower.len()).collect())
}
