//! Decision values of a support-vector machine against those that libsvm computed for the same rows.

use std::path::Path;

use serde::Serialize;

use crate::models::{LibsvmModel, RangeFile};
use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::{numbers, read_text};

/// Features that a model may have; what a shorter one leaves out is 0 on both sides and changes no distance.
const FEATURES_MAX: usize = 128;
/// Cells of a row before its features: label, decision value, probability of label 1.
const KEY_CELLS: usize = 3;
/// Relative difference of a decision value that still is the same computation (issue: 1e-5).
pub const DECISION_ERROR_MAX: f64 = 1.0e-5;
/// A scaled feature beyond this lies outside of what the model was trained on (book, People: Scaling).
const EXTRAPOLATING: f64 = 5.0;

/// How the rows came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SvmReport {
    /// Rows compared.
    pub rows: u64,
    /// Features a row.
    pub features: u64,
    /// Rows with another label than the key.
    pub label_mismatches: u64,
    /// Largest difference of a decision value, relative to the key's.
    pub max_decision_error: f64,
    /// Largest difference of a probability of label 1; none where the model gives no probabilities.
    pub max_probability_error: Option<f64>,
    /// Rows with a feature so far outside of the training range that the probability means nothing.
    pub out_of_distribution: u64,
}

impl SvmReport {
    /// Every label is equal and every decision value within [`DECISION_ERROR_MAX`].
    #[must_use]
    pub fn passed(&self) -> bool {
        self.rows > 0 && self.label_mismatches == 0 && self.max_decision_error <= DECISION_ERROR_MAX
    }
}

/// Compares every row: `predict, decision_value, prob_label_1, f1, f2…` (scaled features), in the order of the names in the
/// first line; in this order where the first line names others or none.
///
/// # Errors
/// A file cannot be read, or rows, range and model do not fit each other.
pub fn svm(model: &Path, range: &Path, rows: &Path) -> anyhow::Result<SvmReport> {
    let file = LibsvmModel::<FEATURES_MAX>::open(model)?;
    let bounds = RangeFile::open(range)?.scaling().ranges.len();
    if file.features() > bounds {
        return Err(BadInput(format!(
            "{} has {} features, but {} names {bounds}; give the range file of this model",
            model.display(),
            file.features(),
            range.display()
        ))
        .into());
    }
    let text = read_text(rows)?;
    let mut report = SvmReport::default();
    let first = text.lines().next().unwrap_or_default();
    let (order, names) = (order_of(first), usize::from(numbers(rows, 1, first).is_err()));
    for (index, line) in text.lines().enumerate().skip(names).filter(|(_, line)| !line.trim().is_empty()) {
        let mut row = numbers(rows, index + 1, line)?;
        if let Some(order) = order.as_ref().filter(|order| order.len() == row.len()) {
            row = order.iter().filter_map(|place| row.get(*place).copied()).collect();
        }
        let features = row.len().saturating_sub(KEY_CELLS);
        if features != bounds || features > FEATURES_MAX {
            return Err(BadInput(format!(
                "{}, line {}: {features} features, but {} names {bounds}; rows are predict,decision_value,prob_label_1,f1,f2… of the same model",
                rows.display(),
                index + 1,
                range.display(),
            ))
            .into());
        }
        let labels = file.labels();
        if !labels.map(f64::from).contains(&row[0]) {
            return Err(BadInput(format!(
                "{}, line {}: label {} is none of the model's ({} and {}); the first column is the label that libsvm predicted",
                rows.display(),
                index + 1,
                row[0],
                labels[0],
                labels[1],
            ))
            .into());
        }
        report.features = features as u64;
        report.compare(&file, &row);
    }
    if report.rows == 0 {
        return Err(BadInput(format!("{}: no rows; it is empty but for its names", rows.display())).into());
    }
    Ok(report)
}

/// Where label, decision, probability and each feature stand, by the names of the columns; `None` if one is missing.
fn order_of(names: &str) -> Option<Vec<usize>> {
    let cells: Vec<&str> = names.split(',').map(str::trim).collect();
    let features = (1..=cells.len().saturating_sub(KEY_CELLS)).map(|number| format!("f{number}"));
    let wanted = ["predict", "decision_value", "prob_label_1"].map(str::to_owned).into_iter().chain(features);
    wanted.map(|name| cells.iter().position(|cell| *cell == name)).collect()
}

impl SvmReport {
    fn compare(&mut self, file: &LibsvmModel<FEATURES_MAX>, row: &[f64]) {
        let mut scaled = [0.0; FEATURES_MAX];
        for (slot, value) in scaled.iter_mut().zip(&row[KEY_CELLS..]) {
            *slot = *value;
        }
        let verdict = file.model().judge(&scaled);
        self.rows += 1;
        self.label_mismatches += u64::from(f64::from(verdict.label) != row[0]);
        let relative = (verdict.decision - row[1]).abs() / row[1].abs().max(f64::MIN_POSITIVE);
        self.max_decision_error = self.max_decision_error.max(relative);
        if let Some(probability) = verdict.probability {
            let error = (probability - row[2]).abs();
            self.max_probability_error =
                Some(self.max_probability_error.map_or(error, |known| known.max(error)));
        }
        self.out_of_distribution += u64::from(scaled.iter().any(|value| value.abs() > EXTRAPOLATING));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_their_names() {
        assert_eq!(order_of("f2, predict,prob_label_1,f1,decision_value\r"), Some(vec![1, 4, 2, 3, 0]));
        assert_eq!(order_of("predict,decision_value,prob_label_1,f1,f2"), Some(vec![0, 1, 2, 3, 4]));
        for foreign in
            ["label,decision,probability,f1", "predict,decision_value,prob_label_1,f1,f3", "1,0.5,0.2,0"]
        {
            assert_eq!(order_of(foreign), None, "{foreign}");
        }
    }
}
