//! The vehicle as this crate sees it: what it is, how it is, and what it is ordered to do. Units are those of the standard: metres,
//! radians, metres a second; the frame is that of the map.

/// What the vehicle is and never changes during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleDescription {
    /// First level of the topics, such as `uagv`.
    pub interface: String,
    /// Its maker.
    pub manufacturer: String,
    /// Its number, unique for its maker.
    pub serial: String,
    /// The map that its places are of.
    pub map_id: String,
    /// Length, width and height of the body, metres.
    pub size_m: [f64; 3],
    /// Greatest speed, m/s.
    pub speed_max_mps: f64,
    /// Greatest acceleration and deceleration, m/s².
    pub acceleration_max_mps2: [f64; 2],
    /// Corners of the body in the vehicle's frame, metres.
    pub outline_m: Vec<[f64; 2]>,
    /// A place counts as reached within, metres, where the order does not say.
    pub within_m: f64,
    /// And within, radians.
    pub within_rad: f64,
    /// What it cleans with, if it cleans on order.
    pub cleaning: Cleaning,
}

/// Whether a vehicle cleans on order.
#[derive(Clone, Debug, PartialEq)]
pub enum Cleaning {
    /// It does, and promises this where an order says nothing else.
    Offered(CleaningPromise),
    /// It does not, and why.
    Refused(String),
}

/// What a cell that a vehicle calls clean may still hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleaningPromise {
    /// Units of dirt that may stay in it.
    pub tolerated_units: u8,
    /// Probability with which it holds no more, 0…1.
    pub confidence: f64,
}

/// Where the vehicle is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VehiclePose {
    /// Along x of the map, metres.
    pub x_m: f64,
    /// Along y of the map, metres.
    pub y_m: f64,
    /// Heading, counter-clockwise from x, radians.
    pub heading_rad: f64,
}

/// How an emergency stop that is active is released.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmergencyStop {
    /// None is active.
    #[default]
    None,
    /// By itself.
    Automatic,
    /// By a person at the vehicle.
    Manual,
}

/// Something that is wrong with the vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VehicleFault {
    /// Its kind, in one word.
    pub kind: String,
    /// In plain words.
    pub words: String,
    /// A person is needed.
    pub is_fatal: bool,
}

/// The vehicle at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VehicleMoment {
    /// Seconds of the vehicle's clock.
    pub now_s: f64,
    /// Where it is, if it knows.
    pub pose: Option<VehiclePose>,
    /// The pose explains what its sensors see.
    pub is_localised: bool,
    /// Speed ahead, m/s, and turning rate, rad/s.
    pub speed: [f64; 2],
    /// It moves, or turns.
    pub is_driving: bool,
    /// Somebody has paused it.
    pub is_paused: bool,
    /// It may be ordered: it is not operated by hand.
    pub is_automatic: bool,
    /// Number of the place that it stands at, of those that were ordered.
    pub reached: Option<u32>,
    /// Number of a place that it cannot reach.
    pub unreachable: Option<u32>,
    /// An emergency stop.
    pub emergency_stop: EmergencyStop,
    /// Something is in its protective field.
    pub is_field_violated: bool,
    /// What is wrong.
    pub faults: Vec<VehicleFault>,
    /// The newest cleaning since the vehicle was switched on.
    pub cleaning: Option<CleaningMoment>,
}

/// How a cleaning stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CleaningStage {
    /// The vehicle cleans, or is held.
    Running,
    /// It is done, with everything that was asked for.
    Finished,
    /// It has ended with less, or never began, and why.
    Failed(String),
}

/// A cleaning at a moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CleaningMoment {
    /// Its number, of those that were ordered.
    pub number: u32,
    /// How it stands.
    pub stage: CleaningStage,
    /// How far it is, in words.
    pub words: String,
}

/// A part of the floor to clean.
#[derive(Clone, Debug, PartialEq)]
pub struct CleaningPlace {
    /// Counts the cleanings; [`CleaningMoment::number`] names it.
    pub number: u32,
    /// Corners in order, metres; none: the whole floor.
    pub corners_m: Vec<[f64; 2]>,
    /// Units of dirt that may stay in a clean cell, where the order says so.
    pub tolerated_units: Option<u8>,
    /// Probability with which a clean cell holds no more, 0…1, where the order says so.
    pub confidence: Option<f64>,
    /// It was begun before the program ended: what was cleaned is known, as far as the vehicle keeps it.
    pub goes_on: bool,
}

/// A place to drive to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderedPlace {
    /// Counts the places; [`VehicleMoment::reached`] names it.
    pub number: u32,
    /// Where.
    pub pose: VehiclePose,
    /// Reached within, metres.
    pub within_m: f64,
    /// And within, radians; π: any heading.
    pub within_rad: f64,
    /// No faster on the way there, m/s, where the order says so.
    pub speed_max_mps: Option<f64>,
    /// And no faster turning, rad/s.
    pub turn_max_radps: Option<f64>,
}

/// What the vehicle is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum VehicleCommand {
    /// Drive there.
    Goto(OrderedPlace),
    /// Clean there, from where it stands.
    Clean(CleaningPlace),
    /// Give up what is being cleaned.
    EndCleaning,
    /// Stand, with nowhere to go and nothing to clean.
    Stand,
    /// Pause.
    Pause,
    /// Go on.
    Resume,
    /// It stands here.
    Relocate(VehiclePose),
}
