//! Drives and cleans by turns. What comes out is a request, as of the drive or of the cleaning alone; the guard decides.

use anyhow::bail;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tasks::{Mission, MissionMoment};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::time::Stamp;

use crate::cleaner::{
    Area, AreaKind, Cleaner, CleaningCommand, CleaningCounts, CleaningOrder, CleaningOrders, CleaningStage,
    CleaningStatus, KnownFloor, MissionOrder, MissionPhase, MissionSetup, QueueStatus,
};
use crate::navigator::{NavigationSetup, Navigator};

/// What a cleaning counts is made known this often, microseconds.
const COUNTS_US: u64 = 1_000_000;
/// Orders that are taken in one step.
const TAKEN_MAX: usize = 16;

/// Drive and cleaning of a robot that somebody outside orders. The drive keeps the robot's place all the time.
pub struct OrderedWork {
    drive: Navigator,
    setup: MissionSetup,
    robot: RobotConfiguration,
    orders: CleaningOrders,
    /// Where an operator lets nobody drive, or drive slowly only.
    drawn: Vec<Area>,
    cleaning: Option<(CleaningOrder, Cleaner)>,
    /// What the brush does while the robot drives; none where the mission has no floor for the robot.
    floor: Option<KnownFloor>,
    status: Option<CleaningStatus>,
    is_reported: bool,
    next_counts_us: u64,
    answer: QueueStatus,
    is_answered: bool,
}

impl OrderedWork {
    /// Ready for orders.
    ///
    /// # Errors
    /// The map has no floor for this robot, or is too large.
    pub fn new(
        (drive, setup): (&NavigationSetup, &MissionSetup),
        robot: &RobotConfiguration,
    ) -> anyhow::Result<Self> {
        let drive = drive.begin(robot)?;
        Ok(Self {
            floor: KnownFloor::new((&setup.plan, robot), &drive.whereabouts()).ok(),
            drive,
            setup: setup.clone(),
            robot: robot.clone(),
            orders: setup.ordered.clone().unwrap_or_default(),
            drawn: Vec::new(),
            cleaning: None,
            status: None,
            // Somebody outside may still believe in what the computer did before it lost its power.
            is_reported: false,
            next_counts_us: 0,
            answer: QueueStatus::default(),
            is_answered: true,
        })
    }

    /// Whether somebody outside orders both: where to drive, and what to clean.
    #[must_use]
    pub const fn is_meant(drive: &NavigationSetup, setup: &MissionSetup) -> bool {
        drive.orders.is_some() && setup.ordered.is_some()
    }

    fn hear_master(&mut self, now: Stamp) {
        for _ in 0..TAKEN_MAX {
            match self.orders.take() {
                Some(CleaningCommand::Clean(order)) => self.begin(order, now),
                Some(CleaningCommand::End) => self.give_up("it was given up", now),
                None => break,
            }
        }
    }

    fn begin(&mut self, order: CleaningOrder, now: Stamp) {
        self.give_up("another one was ordered", now);
        // Nothing is driven to while the robot cleans.
        self.drive.wait_for_order();
        let number = order.number;
        let driven = self.drive.whereabouts();
        let here = self.floor.as_mut().map_or_else(|| driven.clone(), |floor| floor.settled_at(&driven));
        let begun = self.setup.begin_ordered(&self.robot, (&order, &self.drawn), &here);
        let (stage, counts) = match begun {
            Ok(mut cleaner) => {
                if let Some(floor) = self.floor.as_mut().filter(|_| !order.goes_on) {
                    floor.tell(&mut cleaner, now);
                }
                let counts = cleaner.counts();
                self.cleaning = Some((order, cleaner));
                (CleaningStage::Cleaning, Some(counts))
            }
            Err(error) => (CleaningStage::Failed(format!("{error:#}")), None),
        };
        self.tell(CleaningStatus { number, stage, counts });
    }

    /// Ends what is being cleaned before it is done.
    fn give_up(&mut self, why: &str, now: Stamp) {
        self.end(CleaningStage::Failed(why.to_owned()), now);
    }

    fn end(&mut self, stage: CleaningStage, now: Stamp) {
        let Some((order, mut cleaner)) = self.cleaning.take() else { return };
        self.setup.store.forget();
        if !cleaner.phase().is_over() {
            cleaner.cancel();
        }
        cleaner.publish(now);
        let counts = Some(cleaner.counts());
        if let Some(floor) = &mut self.floor {
            floor.learn(&mut cleaner, now);
        }
        self.tell(CleaningStatus { number: order.number, stage, counts });
    }

    fn tell(&mut self, status: CleaningStatus) {
        self.status = Some(status);
        self.is_reported = false;
    }

    /// The cleaning has ended by itself, or the operator has ended it.
    fn conclude(&mut self, now: Stamp) {
        let Some((_, cleaner)) = self.cleaning.as_ref() else { return };
        let counts = cleaner.counts();
        match cleaner.phase() {
            MissionPhase::Done if counts.are_complete() => self.end(CleaningStage::Done, now),
            MissionPhase::Done => {
                self.give_up("nothing more can be done there, and not everything is clean", now)
            }
            MissionPhase::Cancelled => self.give_up("the operator has given it up at the robot", now),
            _ => self.count(now, counts),
        }
    }

    fn count(&mut self, now: Stamp, counts: CleaningCounts) {
        let Some((order, _)) = &self.cleaning else { return };
        let number = order.number;
        self.tell(CleaningStatus { number, stage: CleaningStage::Cleaning, counts: Some(counts) });
        self.next_counts_us = now.as_micros().saturating_add(COUNTS_US);
    }

    /// The operator at the panel draws areas, says where the robot stands, and may give a cleaning up. What is cleaned the master orders.
    fn hear_operator(&mut self) {
        let orders = self.setup.orders.clone();
        for order in orders.take().unwrap_or_default() {
            let outcome = self.obey(order);
            self.answer.answered = self.answer.answered.wrapping_add(1);
            self.answer.refused = outcome.err().map(|error| format!("{error:#}")).unwrap_or_default();
            self.is_answered = false;
        }
        if !self.is_answered {
            self.is_answered = orders.publish(&self.answer);
        }
    }

    fn obey(&mut self, order: MissionOrder) -> anyhow::Result<()> {
        match order {
            MissionOrder::Areas { areas } => self.draw(areas),
            MissionOrder::Locate { x_m, y_m, heading_rad } => {
                let pose = Pose2::new(x_m, y_m, heading_rad);
                if let Some((_, cleaner)) = &mut self.cleaning {
                    cleaner.place_at(pose)?;
                }
                self.drive.place_at(pose);
                Ok(())
            }
            MissionOrder::Cancel { place: 0 } => {
                let Some((_, cleaner)) = &mut self.cleaning else { bail!("no mission runs") };
                cleaner.cancel();
                Ok(())
            }
            MissionOrder::Cancel { .. } => bail!("no mission waits there"),
            MissionOrder::Begin { .. } => bail!("the fleet's master orders what this robot cleans"),
        }
    }

    /// What was cleaned stays cleaned.
    fn draw(&mut self, areas: Vec<Area>) -> anyhow::Result<()> {
        let areas: Vec<Area> = areas.into_iter().filter(|area| area.kind != AreaKind::Clean).collect();
        if let Some((order, cleaner)) = &mut self.cleaning {
            let here = self.drive.whereabouts();
            let again = CleaningOrder { goes_on: true, ..order.clone() };
            let mut next = self.setup.begin_ordered(&self.robot, (&again, &areas), &here)?;
            next.keep_cleaned_of(cleaner);
            *cleaner = next;
        }
        self.drawn = areas;
        Ok(())
    }

    /// One step of the cleaning, if the robot cleans; otherwise what the brush does on the way is noted.
    fn clean(&mut self, moment: &MissionMoment<'_>) -> Option<Twist2> {
        if self.cleaning.is_some() && !self.drive.stands() {
            self.give_up("a place to drive to was ordered meanwhile", moment.now);
        }
        if let (None, Some(floor)) = (&self.cleaning, &mut self.floor) {
            floor.observe(moment, &self.drive.whereabouts());
        }
        let (_, cleaner) = self.cleaning.as_mut()?;
        let requested = cleaner.step(moment);
        if cleaner.phase().is_over() || moment.now.as_micros() >= self.next_counts_us {
            self.conclude(moment.now);
        }
        Some(requested)
    }
}

impl Mission for OrderedWork {
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2 {
        let driven = self.drive.step(moment);
        self.hear_operator();
        self.hear_master(moment.now);
        let requested = self.clean(moment).unwrap_or(driven);
        if !self.is_reported {
            self.is_reported = self.orders.publish(&self.status);
        }
        requested
    }
}

#[cfg(test)]
impl OrderedWork {
    /// Half of the dirty cells are clean by now.
    pub(super) fn clean_half(&mut self) {
        if let Some((_, cleaner)) = &mut self.cleaning {
            cleaner.clean_half();
        }
    }
}
