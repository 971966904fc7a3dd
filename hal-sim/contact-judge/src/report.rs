//! What a run comes to.

use serde::{Deserialize, Serialize};

use crate::{Contact, ContactKind, JobOutcome};

/// Contacts by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ContactCounts {
    /// The moving robot and people or what they carry, whichever of the two moved.
    pub people_while_moving: u32,
    /// Of these: the robot's own motion took its body towards them.
    pub drove_into_people: u32,
    /// The robot drove into objects.
    pub drove_into_things: u32,
    /// A wheel came over an edge.
    pub over_edges: u32,
    /// People walked into the standing robot.
    pub walked_into_standing: u32,
    /// While it moved: a perfect machine with the same brakes would have stood.
    pub avoidable: u32,
    /// Of these: this machine's sensors saw it early enough.
    pub avoidable_by_sensors: u32,
    /// While it moved: beyond the limits of a short impact.
    pub harmful: u32,
    /// A bumper was touched, and the robot went on for longer than it needs to stop.
    pub went_on: u32,
}

impl ContactCounts {
    /// Counts.
    #[must_use]
    pub fn of(contacts: &[Contact]) -> Self {
        let count = |is: &dyn Fn(&&Contact) -> bool| contacts.iter().filter(is).count() as u32;
        let moving = |contact: &&Contact| contact.while_moving();
        let is_kind = |kind| move |contact: &&Contact| contact.kind == kind;
        Self {
            people_while_moving: count(&|contact| contact.is_person() && moving(contact)),
            drove_into_people: count(&|contact| {
                contact.is_person() && contact.kind == ContactKind::DroveInto
            }),
            drove_into_things: count(&|contact| {
                !contact.is_person() && moving(contact) && contact.kind != ContactKind::OverEdge
            }),
            over_edges: count(&is_kind(ContactKind::OverEdge)),
            walked_into_standing: count(&is_kind(ContactKind::WalkedIntoStanding)),
            avoidable: count(&|contact| moving(contact) && contact.avoidable),
            avoidable_by_sensors: count(&|contact| moving(contact) && contact.seen_by.is_some()),
            went_on: count(&|contact| contact.went_on),
            harmful: count(&|contact| moving(contact) && contact.force.class == crate::ForceClass::Harm),
        }
    }

    /// All contacts while the robot moved.
    #[must_use]
    pub const fn while_moving(&self) -> u32 {
        self.people_while_moving + self.drove_into_things + self.over_edges
    }

    /// While it moved: a perfect machine would have stood, and no sensor of this machine saw the other in time.
    #[must_use]
    pub const fn unseen(&self) -> u32 {
        self.avoidable.saturating_sub(self.avoidable_by_sensors)
    }

    /// While it moved: not even a perfect machine with the same brakes would have stood.
    #[must_use]
    pub const fn unavoidable(&self) -> u32 {
        self.while_moving().saturating_sub(self.avoidable)
    }

    /// Contacts that fail no run: those that no sensor saw in time, those that nobody could have avoided, and people who walked
    /// into the standing robot.
    #[must_use]
    pub const fn failing_no_run(&self) -> u32 {
        self.unseen() + self.unavoidable() + self.walked_into_standing
    }

    /// The headline: every contact counts in exactly one of its numbers.
    #[must_use]
    pub fn headline(&self) -> String {
        format!(
            "{} seen in time by a sensor, {} UNSEEN by every sensor, {} that nobody could have avoided; {} people walked into the standing robot",
            self.avoidable_by_sensors,
            self.unseen(),
            self.unavoidable(),
            self.walked_into_standing
        )
    }

    /// Adds those of another run.
    pub const fn add(&mut self, other: &Self) {
        self.people_while_moving += other.people_while_moving;
        self.drove_into_people += other.drove_into_people;
        self.drove_into_things += other.drove_into_things;
        self.over_edges += other.over_edges;
        self.walked_into_standing += other.walked_into_standing;
        self.avoidable += other.avoidable;
        self.avoidable_by_sensors += other.avoidable_by_sensors;
        self.harmful += other.harmful;
        self.went_on += other.went_on;
    }
}

/// The verdict of the judge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// No contact and no missed stop that the sensors could have avoided, no going on with a bumper touched, and the robot
    /// did its job or was kept from it.
    pub passed: bool,
    /// Why not.
    pub failures: Vec<String>,
    /// Contacts by kind.
    pub counts: ContactCounts,
    /// Every contact.
    pub contacts: Vec<Contact>,
    /// The body would have hit something that a sensor had seen, and did not brake in time.
    pub missed_stops: u32,
    /// The same with something that no sensor had seen.
    pub missed_unseen: u32,
    /// Stops for something in the way.
    pub stops: u32,
    /// Those while nothing was near the way.
    pub nuisance_stops: u32,
    /// When these were, seconds.
    pub nuisance_stops_at_s: Vec<f64>,
    /// Smallest gap between the moving robot and anything without a contact, metres; none if nothing ever was near.
    pub clearance_m: Option<f32>,
    /// Deepest penetration, metres.
    pub depth_m: f32,
    /// Of the world, seconds.
    pub duration_s: f64,
    /// Until the robot could move, seconds.
    pub ready_s: Option<f64>,
    /// Way of the rear axle's middle, metres.
    pub travelled_m: f64,
    /// Share of the time in which it moved.
    pub moving_share: f64,
    /// Share of that time in which it turned by more than 0.1 rad/s.
    pub turning_share: f64,
    /// Share of that time in which it drove backwards.
    pub reversing_share: f64,
    /// What came of its job.
    pub job: JobOutcome,
}

/// A robot that came less far than this has not moved, metres.
const MOVED_M: f64 = 0.05;

impl Report {
    /// Decides whether the run passes.
    pub(crate) fn conclude(&mut self, excuse: Option<&str>) {
        let mut failures: Vec<String> = Vec::new();
        let seen = self.counts.avoidable_by_sensors;
        if seen > 0 {
            failures.push(format!("{seen} contacts that the sensors could have avoided"));
        }
        if self.missed_stops > 0 {
            failures.push(format!("{} missed stops", self.missed_stops));
        }
        if self.counts.went_on > 0 {
            failures.push(format!("{} times it went on although a bumper was touched", self.counts.went_on));
        }
        let has_job = self.job != JobOutcome::NoJob;
        match self.ready_s {
            _ if excuse.is_some() || !has_job || matches!(self.job, JobOutcome::Blocked(_)) => {}
            None => failures.push("the robot never became ready".to_owned()),
            Some(_) if self.travelled_m < MOVED_M => {
                failures.push("the robot never moved".to_owned());
            }
            Some(_) => {}
        }
        if self.job == JobOutcome::Undone {
            failures.push("the job is undone, and nothing was in the way".to_owned());
        }
        self.passed = failures.is_empty();
        self.failures = failures;
    }
}
