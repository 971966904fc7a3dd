//! Stochastic descent over rendered pictures, and how good the detector is on others.

use floorguard_detector::{Detector, DetectorConfig, Letterbox, Placing};
use floorguard_types::random::Pcg32;

use super::loss::loss;
use super::network::{FRAME, Network};
use super::pictures::{LabelledPerson, LabelledPicture};

/// Pictures of a step.
const BATCH: usize = 8;
/// Rate of the first step; it falls to nothing along half a cosine.
const RATE: f32 = 0.003;

/// How to train.
#[derive(Clone, Copy, Debug)]
pub struct DetectorTraining {
    /// Times that every picture is shown.
    pub rounds: usize,
    /// Of the weights and of the order.
    pub seed: u64,
}

/// Boxes against the truth of rendered pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectorQuality {
    /// Pictures.
    pub pictures: usize,
    /// People that are not doubtful.
    pub people: usize,
    /// Of them found: a box overlaps by half (intersection over union).
    pub found: usize,
    /// Boxes that are nobody's.
    pub wrong: usize,
}

impl DetectorQuality {
    /// For the console.
    #[must_use]
    pub fn words(&self) -> String {
        let share = |part: usize, all: usize| 100.0 * part as f64 / all.max(1) as f64;
        format!(
            "{} pictures with {} people: {:.1} % found, {:.1} % of the boxes right, {:.2} wrong ones a picture",
            self.pictures,
            self.people,
            share(self.found, self.people),
            share(self.found, self.found + self.wrong),
            self.wrong as f64 / self.pictures.max(1) as f64
        )
    }
}

/// Trains a network; `each` hears the mean loss of every round.
#[must_use]
pub fn train_detector(
    pictures: &[LabelledPicture],
    training: DetectorTraining,
    mut each: impl FnMut(usize, f32),
) -> Network {
    let mut network = Network::new(training.seed);
    let mut random = Pcg32::new(training.seed, 78);
    let mut order: Vec<usize> = (0..pictures.len()).collect();
    let (mut shown, all) = (0_usize, (training.rounds * pictures.len()).max(1));
    // The loss of so few pictures does not fall in every round: what is kept is what the best round began with.
    let mut best: Option<(f32, Network)> = None;
    for round in 0..training.rounds {
        for place in (1..order.len()).rev() {
            order.swap(place, random.below(place as u32 + 1) as usize);
        }
        let (mut sum, before) = (0.0, network.clone());
        for batch in order.chunks(BATCH) {
            for index in batch {
                let (planes, people) = varied(&pictures[*index], &mut random);
                let passed = network.pass(&planes);
                let (cost, slopes) = loss(&passed.grids, &people);
                sum += cost;
                network.learn(&passed, &slopes);
            }
            let done = shown as f32 / all as f32;
            let rate = 0.5 * RATE * (1.0 + libm::cosf(std::f32::consts::PI * done));
            network.descend(rate, batch.len());
            shown += batch.len();
        }
        let cost = sum / order.len().max(1) as f32;
        each(round, cost);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, before));
        }
    }
    best.map_or(network, |(_, network)| network)
}

/// Planes of the frame: mirrored in half of the cases, in another light and other colours.
fn varied(labelled: &LabelledPicture, random: &mut Pcg32) -> (Vec<f32>, Vec<LabelledPerson>) {
    let [width, height] = labelled.picture.size();
    let letterbox = Letterbox::new([width, height], FRAME, Placing::Corner);
    let mut planes = letterbox.fill(&labelled.picture, [2, 1, 0], 1.0);
    let area = (FRAME[0] * FRAME[1]) as usize;
    for plane in planes.chunks_mut(area) {
        let gain = random.uniform_between(0.6, 1.4);
        plane.iter_mut().for_each(|value| *value = (*value * gain).min(255.0));
    }
    let mut people = labelled.people.clone();
    if random.below(2) == 0 {
        let columns = width as usize;
        for row in planes.chunks_mut(FRAME[0] as usize) {
            row[..columns].reverse();
        }
        for person in &mut people {
            let [left, top, right, bottom] = person.edges;
            person.edges = [width as f32 - right, top, width as f32 - left, bottom];
        }
    }
    (planes, people)
}

/// Judges a network through the very detector that runs the file.
///
/// # Panics
/// Never: its output is one of the layouts.
#[must_use]
pub fn judge_detector(network: &Network, pictures: &[LabelledPicture]) -> DetectorQuality {
    let config = DetectorConfig::default();
    let mut detector = Detector::new(Box::new(network.clone()), config).expect("the layout of YOLOX");
    let mut quality = DetectorQuality { pictures: pictures.len(), ..DetectorQuality::default() };
    for labelled in pictures {
        let found = detector.detect(&labelled.picture).expect("it runs");
        let mut is_taken = vec![false; labelled.people.len()];
        for each in found {
            let edges =
                [each.upper_left.column, each.upper_left.row, each.lower_right.column, each.lower_right.row];
            let shared = |person: &LabelledPerson| overlap(edges, person.edges);
            let best = (0..is_taken.len())
                .filter(|index| !is_taken[*index])
                .max_by(|a, b| shared(&labelled.people[*a]).total_cmp(&shared(&labelled.people[*b])));
            match best.filter(|index| shared(&labelled.people[*index]) >= 0.5) {
                Some(index) => is_taken[index] = true,
                None if labelled.people.iter().any(|one| one.is_doubtful && shared(one) > 0.1) => {}
                None => quality.wrong += 1,
            }
        }
        for (person, is_found) in
            labelled.people.iter().zip(is_taken).filter(|(person, _)| !person.is_doubtful)
        {
            let _ = person;
            quality.people += 1;
            quality.found += usize::from(is_found);
        }
    }
    quality
}

fn overlap(a: [f32; 4], b: [f32; 4]) -> f32 {
    let area = |edges: [f32; 4]| (edges[2] - edges[0]).max(0.0) * (edges[3] - edges[1]).max(0.0);
    let both = area([a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]);
    both / (area(a) + area(b) - both).max(1.0e-6)
}
