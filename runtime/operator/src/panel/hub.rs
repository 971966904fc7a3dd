//! Between the robot's side and the browsers: the newest picture one way, a short queue of orders the other way.

use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::Context;
use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_runtime::tape::TapeLine;
use floorguard_types::time::Stamp;
use serde::Deserialize;
use tokio::sync::watch;

use super::access::Access;
use super::brief::brief;
use super::camera_picture::jpeg;
use super::day_keeper::{DayKeeper, Promise};
use super::layers::map_frame;
use super::others::Others;
use super::records::{Records, SharedRecords};
use super::schedule_clock::ScheduleClock;
use super::server;
use super::view::PanelView;
use floorguard_robot::camera::ColourPicture;
use floorguard_robot::cleaner::{Area, AreaKind, MissionOrder, MissionProgress, MissionSetup};
use floorguard_robot::navigator::NavigationProgress;

/// Pictures come this often at most.
const EVERY: Duration = Duration::from_millis(100);
/// Orders that wait for the robot's side; more are refused.
const ORDERS_MAX: usize = 8;

/// What a button orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// The mission waits.
    Pause,
    /// The mission goes on.
    Resume,
    /// The operator asks the guard to release a latched stop.
    Reset,
    /// The operator gives the start command.
    Start,
}

impl Order {
    /// How it stands in a recording.
    #[must_use]
    pub const fn line(self) -> TapeLine {
        match self {
            Self::Pause => TapeLine::Pause,
            Self::Resume => TapeLine::Resume,
            Self::Reset => TapeLine::Reset,
            Self::Start => TapeLine::Start,
        }
    }

    /// Gives it to the tasks.
    pub fn apply<M: RawMutex>(self, shared: &Shared<M>) {
        match self {
            Self::Pause => shared.pause(true),
            Self::Resume => shared.pause(false),
            Self::Reset => shared.reset.signal(()),
            Self::Start => shared.start.signal(()),
        }
    }
}

/// What an operator has ordered.
#[derive(Clone, Debug, PartialEq)]
pub enum PanelOrder {
    /// A button.
    Button(Order),
    /// An order to the mission.
    Mission(MissionOrder),
}

impl From<Order> for PanelOrder {
    fn from(order: Order) -> Self {
        Self::Button(order)
    }
}

/// What the browsers' side knows.
#[derive(Clone)]
pub(super) struct Hub {
    pub access: Arc<Access>,
    /// What runs.
    pub title: Arc<str>,
    /// Number and text of the newest picture.
    pub newest: watch::Receiver<(u64, Arc<str>)>,
    /// Number and text of the newest floor of a mission.
    pub layers: watch::Receiver<(u64, Arc<str>)>,
    /// What the robot of the newest picture waits for.
    pub awaited: watch::Receiver<Option<Order>>,
    /// The map of the mission, if there is one.
    pub map: watch::Receiver<Arc<str>>,
    /// Areas, alerts, days, schedules, parts.
    pub records: SharedRecords,
    /// This robot in short.
    pub brief: watch::Receiver<Arc<str>>,
    /// Other robots.
    pub others: Others,
    /// The camera's newest picture, a JPEG file; empty before the first.
    pub camera: watch::Receiver<Arc<[u8]>>,
    orders: Arc<Mutex<SyncSender<PanelOrder>>>,
}

impl Hub {
    /// Queues an order. False when too many wait.
    pub fn order(&self, order: impl Into<PanelOrder>) -> bool {
        let orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        !matches!(orders.try_send(order.into()), Err(TrySendError::Full(_)))
    }
}

/// The robot's end of the panel.
pub struct Panel {
    view: PanelView,
    newest: watch::Sender<(u64, Arc<str>)>,
    layers: watch::Sender<(u64, Arc<str>)>,
    awaited: watch::Sender<Option<Order>>,
    map: watch::Sender<Arc<str>>,
    brief: watch::Sender<Arc<str>>,
    camera: watch::Sender<Arc<[u8]>>,
    pictures: u64,
    records: SharedRecords,
    days: DayKeeper,
    schedules: ScheduleClock,
    orders: Receiver<PanelOrder>,
    drawn: Option<Instant>,
    address: SocketAddr,
    start: Stamp,
}

impl Panel {
    /// Opens the panel: it can be examined from now on.
    ///
    /// # Errors
    /// The address is taken, or the thread cannot start.
    pub fn open(access: Access, view: PanelView, records: Records) -> anyhow::Result<Self> {
        let listener = std::net::TcpListener::bind(access.address)
            .with_context(|| format!("--panel {}: this address cannot be opened", access.address))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (newest, newest_seen) = watch::channel((0, Arc::from("{}")));
        let (layers, layers_seen) = watch::channel((0, Arc::from("{}")));
        let (map, map_seen) = watch::channel(Arc::from("{}"));
        let records = SharedRecords::new(records);
        let (awaited, awaited_seen) = watch::channel(None);
        let (brief, brief_seen) = watch::channel(Arc::from("{}"));
        let (camera, camera_seen) = watch::channel(Arc::from([]));
        let others = Others::new(&view.configured.robots);
        let (sender, orders) = sync_channel(ORDERS_MAX);
        let hub = Hub {
            access: Arc::new(access),
            title: Arc::from(view.title()),
            newest: newest_seen,
            layers: layers_seen,
            awaited: awaited_seen,
            map: map_seen,
            records: records.clone(),
            brief: brief_seen,
            others,
            camera: camera_seen,
            orders: Arc::new(Mutex::new(sender)),
        };
        say!("  panel: http://{address}/#{}", hub.access.token);
        std::thread::Builder::new().name("panel".to_owned()).spawn(move || server::serve(listener, hub))?;
        Ok(Self {
            days: DayKeeper::new(records.clone(), &view.configured.consumables),
            schedules: ScheduleClock::new(records.clone()),
            view,
            newest,
            layers,
            awaited,
            map,
            brief,
            camera,
            pictures: 0,
            records,
            orders,
            drawn: None,
            address,
            start: Stamp::ZERO,
        })
    }

    /// Where it listens; with port 0 the system has chosen one.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// The robot's clock at the time that the page calls zero.
    pub const fn set_clock_start(&mut self, start: Stamp) {
        self.start = start;
    }

    /// What the robot cleans: its map is shown, and its missions can be ordered. The areas that are kept reach it first.
    pub fn set_mission(&mut self, setup: &MissionSetup) {
        let map = setup.plan.occupancy().ok().and_then(|map| serde_json::to_string(&map_frame(&map)).ok());
        if let Some(map) = map {
            self.map.send_replace(map.into());
        }
        let confidence_percent = 100.0 * (1.0 - setup.plan.delta);
        self.days.promise = Promise { confidence_percent, tolerated_units: setup.plan.tolerated_units };
        self.view.missions = Some(setup.orders.clone());
        self.schedules.has_mission = true;
    }

    /// The areas that every mission keeps to; none if nothing was drawn.
    #[must_use]
    pub fn kept_areas(&self) -> Option<MissionOrder> {
        let areas = standing_areas(&self.records.lock().kept().areas);
        (!areas.is_empty()).then_some(MissionOrder::Areas { areas })
    }

    /// A lidar datagram, for the points of the picture.
    pub fn lidar_datagram(&mut self, datagram: &[u8], arrival: Stamp) {
        self.view.lidar_datagram(datagram, arrival);
    }

    /// Bytes of another line: those of the bus tell what the robot uses up.
    pub fn can_frame(&mut self, bytes: &[u8], arrival: Stamp) {
        self.view.supplies.can_frame(bytes, arrival);
    }

    /// A picture of the floor camera, about once a second.
    pub fn camera_picture(&mut self, picture: &ColourPicture) {
        if let Some(file) = jpeg(picture) {
            self.pictures += 1;
            self.camera.send_replace(file.into());
        }
    }

    /// A stop that began.
    pub fn stop(&mut self, record: &StopRecord) {
        let cause = self.view.stop(record, self.start);
        self.days.alert(&cause);
    }

    /// The cleaning mission has reported its progress.
    pub fn mission(&mut self, progress: &Arc<MissionProgress>) {
        let layers = self.view.mission(progress);
        if let Ok(text) = serde_json::to_string(&layers) {
            self.layers.send_replace((layers.number, text.into()));
        }
    }

    /// The drive to a goal has reported its progress.
    pub fn navigation(&mut self, progress: &Arc<NavigationProgress>) {
        self.view.navigation(progress);
    }

    /// Makes a picture when it is time for one. Cheap to call at any rate.
    pub fn publish<M: RawMutex>(&mut self, shared: &Shared<M>) {
        if self.drawn.is_some_and(|drawn| drawn.elapsed() < EVERY) {
            return;
        }
        self.drawn = Some(Instant::now());
        let Some(mut frame) = self.view.frame(shared, self.start) else { return };
        self.days.look(&frame);
        self.schedules.look();
        let alerts = {
            let records = self.records.lock();
            frame.records = records.number();
            frame.supplies = self.view.supplies.frame(frame.stamp, &records.kept().parts);
            records.kept().alerts.open()
        };
        frame.camera = self.pictures;
        frame.robots = self.view.configured.robots.len();
        self.brief.send_replace(brief(&frame, alerts).to_string().into());
        self.awaited.send_replace(frame.awaited());
        if let Ok(text) = serde_json::to_string(&frame) {
            self.newest.send_replace((frame.number, text.into()));
        }
    }

    /// The next order of an operator.
    pub fn order(&mut self) -> Option<PanelOrder> {
        self.schedules.order().map(PanelOrder::Mission).or_else(|| self.orders.try_recv().ok())
    }
}

/// What begins when a mission names these areas; `None` if one of them is not kept.
pub(super) fn mission_of(names: &[String], kept: &[Area]) -> Option<MissionOrder> {
    let of_name =
        |name: &String| kept.iter().find(|area| area.kind == AreaKind::Clean && area.name == *name).cloned();
    let cleaned: Vec<Area> = names.iter().map(of_name).collect::<Option<_>>()?;
    Some(MissionOrder::Begin { name: names.join(", "), areas: [cleaned, standing_areas(kept)].concat() })
}

/// Areas that bind every mission: the others are cleaned when a mission names them.
pub(super) fn standing_areas(areas: &[Area]) -> Vec<Area> {
    areas.iter().filter(|area| area.kind != AreaKind::Clean).cloned().collect()
}
