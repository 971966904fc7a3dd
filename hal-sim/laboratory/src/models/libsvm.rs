//! The `.model` file of libsvm: two classes, radial kernel. Source: book, People: Support-vector machine.

use std::path::Path;

use floorguard_perception::people::classify::{Platt, SvmModel};

use super::{ModelError, read};

/// A model with `DIMENSIONS` features, dense and in double precision, as libsvm computes.
#[derive(Clone, Debug, PartialEq)]
pub struct LibsvmModel<const DIMENSIONS: usize> {
    gamma: f64,
    rho: f64,
    labels: [i32; 2],
    platt: Option<Platt>,
    weights: Vec<f64>,
    vectors: Vec<[f64; DIMENSIONS]>,
}

/// What the lines before `SV` say.
#[derive(Default)]
struct Header {
    gamma: Option<f64>,
    rho: Option<f64>,
    labels: Option<[i32; 2]>,
    total: Option<usize>,
    probability: [Option<f64>; 2],
}

impl<const DIMENSIONS: usize> LibsvmModel<DIMENSIONS> {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, is no two-class C-SVC with a radial kernel, is cut off, or has more features.
    pub fn open(path: &Path) -> Result<Self, ModelError> {
        Self::parse(&read(path)?, &path.display().to_string())
    }

    /// Reads a text; `name` is used in errors.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn parse(text: &str, name: &str) -> Result<Self, ModelError> {
        let line_error =
            |line: usize, problem: String| ModelError::Line { path: name.to_owned(), line, problem };
        let missing = |what: &str| ModelError::Incomplete { path: name.to_owned(), problem: what.to_owned() };
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        let mut header = Header::default();
        let mut found = false;
        for (line, content) in lines.by_ref() {
            if content == "SV" {
                found = true;
                break;
            }
            header.take(content).map_err(|problem| line_error(line, problem))?;
        }
        if !found {
            return Err(missing("there is no line `SV`"));
        }
        let (mut weights, mut vectors) = (Vec::new(), Vec::new());
        for (line, content) in lines.filter(|(_, content)| !content.is_empty()) {
            let (weight, vector) = support_vector(content).map_err(|problem| line_error(line, problem))?;
            weights.push(weight);
            vectors.push(vector);
        }
        if header.total.is_some_and(|total| total != weights.len()) {
            return Err(missing(&format!(
                "{} support vectors, not as many as `total_sv`; the file is cut off or was edited, copy it again",
                weights.len()
            )));
        }
        let platt = match header.probability {
            [Some(a), Some(b)] => Some(Platt { a, b }),
            _ => None,
        };
        Ok(Self {
            gamma: header.gamma.ok_or_else(|| missing("`gamma` is missing"))?,
            rho: header.rho.ok_or_else(|| missing("`rho` is missing"))?,
            labels: header.labels.ok_or_else(|| missing("`label` is missing"))?,
            platt,
            weights,
            vectors,
        })
    }

    /// The labels, in the order of the file.
    #[must_use]
    pub const fn labels(&self) -> [i32; 2] {
        self.labels
    }

    /// The highest feature that any support vector has.
    #[must_use]
    pub fn features(&self) -> usize {
        let highest = |vector: &[f64; DIMENSIONS]| vector.iter().rposition(|value| *value != 0.0);
        self.vectors.iter().filter_map(highest).max().map_or(0, |index| index + 1)
    }

    /// For the classifier of the core.
    #[must_use]
    pub fn model(&self) -> SvmModel<'_, DIMENSIONS, f64> {
        SvmModel {
            gamma: self.gamma,
            rho: self.rho,
            labels: self.labels,
            weights: &self.weights,
            vectors: &self.vectors,
            platt: self.platt,
        }
    }
}

impl Header {
    fn take(&mut self, content: &str) -> Result<(), String> {
        let (key, value) = content.split_once(' ').ok_or_else(|| format!("`{content}` has no value"))?;
        let number = || {
            let number = value.parse::<f64>().map_err(|error| format!("`{content}`: {error}"))?;
            if number.is_finite() { Ok(number) } else { Err(format!("`{content}`: not finite")) }
        };
        match key {
            "svm_type" if value != "c_svc" => return Err(format!("only c_svc is known, not {value}")),
            "kernel_type" if value != "rbf" => return Err(format!("only rbf is known, not {value}")),
            "nr_class" if value != "2" => return Err(format!("only two classes are known, not {value}")),
            "gamma" => {
                let gamma = number()?;
                if gamma <= 0.0 {
                    return Err(format!("`{content}`: a radial kernel needs more than 0"));
                }
                self.gamma = Some(gamma);
            }
            "rho" => self.rho = Some(number()?),
            "probA" => self.probability[0] = Some(number()?),
            "probB" => self.probability[1] = Some(number()?),
            "total_sv" => self.total = Some(value.parse().map_err(|error| format!("`{content}`: {error}"))?),
            "label" => {
                let labels: Vec<i32> =
                    value.split_whitespace().filter_map(|label| label.parse().ok()).collect();
                self.labels =
                    Some(labels.try_into().map_err(|_| format!("`{content}` names not two labels"))?);
            }
            _ => {}
        }
        Ok(())
    }
}

/// `weight index:value …`; what is left out is 0.
fn support_vector<const DIMENSIONS: usize>(content: &str) -> Result<(f64, [f64; DIMENSIONS]), String> {
    let mut cells = content.split_whitespace();
    let weight = cells.next().and_then(|cell| cell.parse().ok()).filter(|weight: &f64| weight.is_finite());
    let weight = weight.ok_or("the weight is no number")?;
    let mut vector = [0.0; DIMENSIONS];
    for cell in cells {
        let (index, value) = cell.split_once(':').ok_or_else(|| format!("`{cell}` is no index:value"))?;
        let index: usize = index.parse().map_err(|error| format!("`{cell}`: {error}"))?;
        let slot = index
            .checked_sub(1)
            .and_then(|index| vector.get_mut(index))
            .ok_or_else(|| format!("`{cell}`: features run from 1 to {DIMENSIONS}"))?;
        let value: f64 = value.parse().map_err(|error| format!("`{cell}`: {error}"))?;
        if !value.is_finite() {
            return Err(format!("`{cell}`: not finite"));
        }
        *slot = value;
    }
    Ok((weight, vector))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "svm_type c_svc\nkernel_type rbf\ngamma 0.5\nnr_class 2\ntotal_sv 2\nrho 0.25\nlabel 1 -1\n\
                        probA -2\nprobB 0.5\nnr_sv 1 1\nSV\n1 1:1\n-1 2:-0.5 \n";

    #[test]
    fn a_model_is_read() {
        let model = LibsvmModel::<2>::parse(GOOD, "a.model").expect("good");
        assert_eq!(model.vectors, [[1.0, 0.0], [0.0, -0.5]]);
        assert_eq!(model.platt, Some(Platt { a: -2.0, b: 0.5 }));
    }

    #[test]
    fn broken_models_are_refused() {
        for (from, to) in [
            ("c_svc", "nu_svc"),
            ("rbf", "linear"),
            ("nr_class 2", "nr_class 3"),
            ("total_sv 2", "total_sv 3"),
            ("gamma 0.5", "gamma half"),
            ("gamma 0.5", "gamma nan"),
            ("gamma 0.5", "gamma -1"),
            ("rho 0.25", "rho inf"),
            ("-1 2:-0.5", "nan 2:-0.5"),
            ("2:-0.5", "2:inf"),
            ("label 1 -1", "label 1"),
            ("rho 0.25\n", ""),
            ("SV\n", ""),
            ("2:-0.5", "3:-0.5"),
            ("2:-0.5", "0:-0.5"),
            ("-1 2", "x 2"),
        ] {
            let text = GOOD.replace(from, to);
            assert!(LibsvmModel::<2>::parse(&text, "a.model").is_err(), "{from} → {to}");
        }
    }
}
