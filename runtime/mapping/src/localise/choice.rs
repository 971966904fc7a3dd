//! Several floors and buildings: which of their maps the robot is in.

use super::LocaliseConfig;
use super::known_map::KnownMap;
use super::localiser::{Belief, Localiser, Located};
use crate::input::ScanRecord;

/// A place counts once no other map fitted nearly as well for so long, seconds.
const HELD_S: f64 = 3.0;

/// The answer after a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chosen {
    /// Which of the maps; `None` while none or several fit.
    pub map: Option<usize>,
    /// The place in it.
    pub located: Located,
}

/// Localises a drive in one of several maps.
pub struct MapChoice {
    localisers: Vec<Localiser>,
    margin: f64,
    chosen: Option<usize>,
    /// The only map that fits, and since when, seconds.
    leading: Option<(usize, f64)>,
}

impl MapChoice {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(maps: Vec<KnownMap>, config: LocaliseConfig) -> Self {
        let localisers = maps.into_iter().map(|map| Localiser::new(map, config)).collect();
        Self { localisers, margin: config.support_margin, chosen: None, leading: None }
    }

    /// The localisers, in the order of the maps.
    #[must_use]
    pub fn localisers(&self) -> &[Localiser] {
        &self.localisers
    }

    /// Takes the next scan. All maps are searched until one is chosen; it is left again when the place in it is lost.
    pub fn push(&mut self, record: &ScanRecord) -> Chosen {
        if let Some(map) = self.chosen {
            let located = self.localisers[map].push(record);
            if located.belief != Belief::Unknown {
                return Chosen { map: Some(map), located };
            }
            self.chosen = None;
            self.leading = None;
            self.localisers.iter_mut().for_each(Localiser::reset);
            return Chosen { map: None, located };
        }
        let answers: Vec<Located> = self.localisers.iter_mut().map(|each| each.push(record)).collect();
        let Some(map) = self.alone(&answers) else {
            self.leading = None;
            return Chosen { map: None, located: unknown(&answers) };
        };
        let since_s =
            self.leading.filter(|leading| leading.0 == map).map_or(record.time_s, |leading| leading.1);
        self.leading = Some((map, since_s));
        let is_single = self.localisers.len() == 1;
        if is_single || record.time_s - since_s >= HELD_S {
            self.chosen = Some(map);
            return Chosen { map: Some(map), located: answers[map] };
        }
        Chosen { map: None, located: unknown(&answers) }
    }

    /// The only map with a place, if no other map has one that fits nearly as well.
    fn alone(&self, answers: &[Located]) -> Option<usize> {
        let mut placed = (0..answers.len()).filter(|&map| answers[map].pose.is_some());
        let map = placed.next().filter(|_| placed.next().is_none())?;
        let least = self.localisers[map].best_support() - self.margin;
        let is_beaten = |other: usize| other == map || self.localisers[other].best_support() <= least;
        (0..answers.len()).all(is_beaten).then_some(map)
    }
}

/// No place; help is asked for as soon as one of the maps asks.
fn unknown(answers: &[Located]) -> Located {
    Located { asks_for_help: answers.iter().any(|answer| answer.asks_for_help), ..Located::default() }
}
