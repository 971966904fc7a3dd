//! The published sweeps of η, ζ and β_max for moving objects, repeated: `cargo xtask reproduce motion`.
//!
//! After Rath et al. 2020: one person walks in a corridor, a lidar drives by, poses come from an odometry. The
//! published steps (`corridor::published`) and ours are judged on the same sweeps.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_perception::motion::MotionParameters;

use crate::corridor::{Method, Run, Score, judge, record};

/// First seed; those below 120 were examined while parameters were chosen.
const SEED: u64 = 1_000;
/// Sweeps of a run: 15 s.
const SWEEPS: usize = 150;
/// Published at ζ = 4, β_max = 3, η = 20: percent, and false positives.
const PUBLISHED: (f64, u32) = (91.42, 6);
/// What ours must reach at the same values, and what the published steps must.
const OURS_MIN: f64 = 95.0;
const OURS_FALSE_MAX: u32 = 3;
const PUBLISHED_MIN: f64 = 85.0;

/// A method, its name and the parameters that are not swept.
struct Contender {
    name: &'static str,
    method: Method,
    parameters: MotionParameters,
}

const OURS: usize = 0;
const AS_PUBLISHED: usize = 1;

const CONTENDERS: [Contender; 3] = [
    Contender {
        name: "ours, 8 m",
        method: Method::Own { reach_m: 8.0 },
        parameters: MotionParameters::FIXED,
    },
    Contender {
        name: "published steps, 3 m",
        method: Method::Published { crop_m: 3.0, points_min: 200 },
        parameters: MotionParameters::PAPER,
    },
    Contender {
        name: "published steps, 8 m",
        method: Method::Published { crop_m: 8.0, points_min: 30 },
        parameters: MotionParameters::PAPER,
    },
];

/// A parameter that is swept.
struct Figure {
    title: &'static str,
    file: &'static str,
    symbol: &'static str,
    values: &'static [u16],
    set: fn(&mut MotionParameters, u16),
}

const FIGURES: [Figure; 3] = [
    Figure {
        title: "Figure 6: sensitivity η (ζ = 4, β_max = 3)",
        file: "figure_six",
        symbol: "η",
        values: &[5, 10, 15, 20, 25, 30, 35, 40],
        set: |parameters, value| parameters.sensitivity = value,
    },
    Figure {
        title: "Figure 7: moving confidence ζ (β_max = 3, η = 20)",
        file: "figure_seven",
        symbol: "ζ",
        values: &[2, 3, 4, 5, 6],
        set: |parameters, value| parameters.chain = value as u8,
    },
    Figure {
        title: "Figure 8: static confidence β_max (ζ = 4, η = 20)",
        file: "figure_eight",
        symbol: "β_max",
        values: &[1, 2, 3, 4, 5],
        set: |parameters, value| parameters.rest_max = value as u8,
    },
];

/// Scores per figure, value and contender, summed over the runs.
pub struct MotionFigures {
    runs: u64,
    sweeps: usize,
    scores: Vec<Vec<[Score; CONTENDERS.len()]>>,
    /// At ζ = 4, β_max = 3, η = 20, per run.
    optimum: Vec<[Score; CONTENDERS.len()]>,
}

/// Records `runs` seeds of so many sweeps each and judges each with every method and value.
#[must_use]
pub fn motion_figures(runs: u64, sweeps: usize) -> MotionFigures {
    let empty =
        FIGURES.iter().map(|figure| vec![<[Score; CONTENDERS.len()]>::default(); figure.values.len()]);
    let mut figures = MotionFigures { runs, sweeps, scores: empty.collect(), optimum: Vec::new() };
    for seed in SEED..SEED + runs {
        figures.enter(&record(seed, sweeps));
    }
    figures
}

impl MotionFigures {
    fn enter(&mut self, run: &Run) {
        for (figure, scores) in FIGURES.iter().zip(&mut self.scores) {
            std::thread::scope(|scope| {
                for (value, sums) in figure.values.iter().zip(scores) {
                    scope.spawn(move || {
                        for (contender, sum) in CONTENDERS.iter().zip(sums) {
                            let mut parameters = contender.parameters;
                            (figure.set)(&mut parameters, *value);
                            sum.add(&judge(run, contender.method, parameters));
                        }
                    });
                }
            });
        }
        self.optimum.push(CONTENDERS.map(|contender| judge(run, contender.method, contender.parameters)));
    }

    fn total(&self, contender: usize) -> Score {
        let mut total = Score::default();
        for scores in &self.optimum {
            total.add(&scores[contender]);
        }
        total
    }

    /// All figures as tables.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "Moving objects: {} runs of {} sweeps, seeds from {SEED}; accuracy = found of present, false = moving \
             objects elsewhere.\nPublished at ζ = 4, β_max = 3, η = 20: {} % with {} false, one run.\n\n",
            self.runs, self.sweeps, PUBLISHED.0, PUBLISHED.1
        );
        for (index, contender) in CONTENDERS.iter().enumerate() {
            let total = self.total(index);
            let worst = self.optimum.iter().map(|scores| scores[index].accuracy()).fold(100.0, f64::min);
            let most = self.optimum.iter().map(|scores| scores[index].false_positives).max().unwrap_or(0);
            let _infallible = writeln!(
                text,
                "{:<22} {:>6.2} % of {:>5}, {:>4} false; worst run {worst:.2} %, most false in a run {most}",
                contender.name,
                total.accuracy(),
                total.present,
                total.false_positives,
            );
        }
        for (figure, scores) in FIGURES.iter().zip(&self.scores) {
            let _infallible = writeln!(text, "\n{}\n{:>6}  {}", figure.title, figure.symbol, heads());
            for (value, scores) in figure.values.iter().zip(scores) {
                let cells = scores.map(|s| format!("{:>8.2} % {:>9} false", s.accuracy(), s.false_positives));
                let _infallible = writeln!(text, "{value:>6}  {}", cells.join("   "));
            }
        }
        text
    }

    /// Ours reaches its goals; the published steps reach theirs and follow the published trends.
    #[must_use]
    pub fn holds(&self) -> bool {
        let (ours, published) = (self.total(OURS), self.total(AS_PUBLISHED));
        ours.accuracy() >= OURS_MIN
            && ours.false_positives <= OURS_FALSE_MAX
            && published.accuracy() >= PUBLISHED_MIN
            && self.trends_hold()
    }

    /// Alarms of the published steps from one end of each figure to the other: more with η, fewer with ζ, more with
    /// β_max.
    #[must_use]
    pub fn trends_hold(&self) -> bool {
        let ends = |figure: usize| -> Option<(u32, u32)> {
            let scores = self.scores.get(figure)?;
            let alarms = |scores: &[Score; CONTENDERS.len()]| scores[CONTENDERS.len() - 1].false_positives;
            Some((alarms(scores.first()?), alarms(scores.last()?)))
        };
        ends(0).is_some_and(|(first, last)| first <= last)
            && ends(1).is_some_and(|(first, last)| first >= last)
            && ends(2).is_some_and(|(first, last)| first <= last)
    }

    /// Two pictures per figure: accuracy and alarms.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        for (figure, scores) in FIGURES.iter().zip(&self.scores) {
            type Value = fn(&Score, f64) -> f64;
            let quantities: [(&str, &str, Value); 2] = [
                ("accuracy", "found of present, %", |score, _| score.accuracy()),
                ("false", "false positives a run", |score, runs| f64::from(score.false_positives) / runs),
            ];
            for (name, unit, value) in quantities {
                let line = |(index, contender): (usize, &Contender)| Series {
                    name: contender.name.to_owned(),
                    points: figure
                        .values
                        .iter()
                        .zip(scores)
                        .map(|(x, scores)| (f64::from(*x), value(&scores[index], self.runs as f64)))
                        .collect(),
                };
                let mut series: Vec<Series> = CONTENDERS.iter().enumerate().map(line).collect();
                let published = if name == "accuracy" { PUBLISHED.0 } else { f64::from(PUBLISHED.1) };
                let ends = [figure.values.first(), figure.values.last()].into_iter().flatten();
                let points = ends.map(|x| (f64::from(*x), published)).collect();
                series.push(Series { name: "published optimum".to_owned(), points });
                let path = folder.join(format!("{}_{name}.svg", figure.file));
                line_plot(&path, (figure.title, figure.symbol, unit), &series)?;
            }
        }
        Ok(())
    }
}

fn heads() -> String {
    CONTENDERS.iter().map(|contender| format!("{:>26}", contender.name)).collect::<Vec<_>>().join("   ")
}

/// Runs everything with `runs` seeds, writes the table and the pictures into `folder`, and returns the text and whether
/// everything that must show did.
///
/// # Errors
/// A folder or a file that cannot be written.
pub fn motion(runs: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let figures = motion_figures(runs, SWEEPS);
    let text = figures.text();
    eprintln!("{text}");
    figures.draw(folder)?;
    std::fs::write(folder.join("motion.txt"), &text)?;
    Ok((text, figures.holds()))
}
