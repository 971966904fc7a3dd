//! Why a person got another identity: what had become of the old track, and where the new one came from.
//!
//! Beside the metric, which only counts: a crowd hides everybody again and again, and it matters whether names are lost
//! while people stand in plain sight, while they are hidden, or when they come out again.

use std::collections::BTreeMap;

use floorguard_types::geometry::Point2;

/// A track belongs to whom it follows within this distance, metres.
const NEAR_M: f32 = 0.7;
/// A track that is somewhere else from one sweep to the next was given to somebody else by recall, metres.
const LEAP_M: f32 = 0.35;

/// What became of the old track.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lost {
    /// It went over to somebody else while its person was in sight.
    TakenInSight,
    /// It went over to somebody else while its person was hidden, step by step: the association took it along.
    TakenWhileHidden,
    /// Somebody who came out of sight was given the name of the person, who was still hidden or not yet recalled.
    GivenAway,
    /// It still waits near the person: two tracks for one person.
    Doubled,
    /// It waits where nobody is.
    Strayed,
    /// It was given up.
    Forgotten,
}

impl Lost {
    /// All, in the order of the table.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::TakenInSight, "went over in plain sight"),
        (Self::TakenWhileHidden, "went over while hidden"),
        (Self::GivenAway, "given to somebody who came out"),
        (Self::Doubled, "two tracks on one person"),
        (Self::Strayed, "old track waits elsewhere"),
        (Self::Forgotten, "old track given up"),
    ];
}

/// One person of a frame: number, place, in sight.
pub type ObservedPerson = (u64, Point2, bool);

#[derive(Clone, Copy, Debug)]
struct Owner {
    person: u64,
    place: Point2,
}

/// Follows who owns which track.
#[derive(Clone, Debug, Default)]
pub struct Causes {
    owners: BTreeMap<u64, Owner>,
    /// How each track left each person whom it left last.
    left: BTreeMap<(u64, u64), Lost>,
    partners: BTreeMap<u64, u64>,
    /// How often each cause came, and with a fresh track (first) or one that had had another person (second).
    pub counts: BTreeMap<Lost, [u32; 2]>,
}

impl Causes {
    /// One sweep: everybody, all tracks that exist (also unreported ones), and the pairs of the metric.
    pub fn frame(&mut self, people: &[ObservedPerson], tracks: &[(u64, Point2)], pairs: &BTreeMap<u64, u64>) {
        for (person, track) in pairs {
            let before = self.partners.insert(*person, *track);
            if let Some(old) = before.filter(|old| old != track) {
                let fresh = !self.owners.contains_key(track)
                    || self.owners.get(track).is_some_and(|owner| owner.person == *person);
                let cause = self.cause(*person, old, people, tracks);
                let slot = self.counts.entry(cause).or_default();
                slot[usize::from(!fresh)] += 1;
            }
        }
        self.follow(people, tracks);
    }

    fn cause(&self, person: u64, old: u64, people: &[ObservedPerson], tracks: &[(u64, Point2)]) -> Lost {
        let Some((_, place)) = tracks.iter().find(|(id, _)| *id == old) else { return Lost::Forgotten };
        let me = people.iter().find(|other| other.0 == person);
        if me.is_some_and(|me| me.1.distance(*place) < NEAR_M)
            && self.owners.get(&old).is_none_or(|owner| owner.person == person)
        {
            return Lost::Doubled;
        }
        self.left.get(&(person, old)).copied().unwrap_or(Lost::Strayed)
    }

    /// A track stays with its person while it is near; else it goes to the nearest.
    fn follow(&mut self, people: &[ObservedPerson], tracks: &[(u64, Point2)]) {
        for (id, place) in tracks {
            let before = self.owners.get(id).copied();
            let stays = before.is_some_and(|owner| {
                people.iter().any(|other| other.0 == owner.person && other.1.distance(*place) < NEAR_M)
            });
            let nearest = people.iter().min_by(|a, b| a.1.distance(*place).total_cmp(&b.1.distance(*place)));
            let Some(nearest) = nearest.filter(|nearest| nearest.1.distance(*place) < NEAR_M) else {
                if let Some(owner) = self.owners.get_mut(id) {
                    owner.place = *place;
                }
                continue;
            };
            let person = if stays { before.map_or(nearest.0, |owner| owner.person) } else { nearest.0 };
            if let Some(owner) = before.filter(|owner| owner.person != person) {
                let in_sight = people.iter().any(|other| other.0 == owner.person && other.2);
                let cause = if owner.place.distance(*place) > LEAP_M {
                    Lost::GivenAway
                } else if in_sight {
                    Lost::TakenInSight
                } else {
                    Lost::TakenWhileHidden
                };
                self.left.insert((owner.person, *id), cause);
            }
            self.owners.insert(*id, Owner { person, place: *place });
        }
    }
}
