//! What the protocol has to know about the vehicle: SI units, radians.

use fcc_telemetry::Command;

/// The number of a link.
pub type LinkId = u16;

/// The time, as its owner tells it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Now {
    /// Since any start, ms; never goes back.
    pub ms: u64,
    /// Since 1970, UTC, µs.
    pub utc_us: u64,
}

/// Who the vehicle says that it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Identity {
    /// `MAV_AUTOPILOT_GENERIC`.
    #[default]
    Generic,
    /// `MAV_AUTOPILOT_PX4`, for stations that offer modes only to autopilots they know.
    Px4,
}

/// A place on the WGS-84 ellipsoid.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Position {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Above mean sea level, m.
    pub altitude_m: f64,
}

/// The attitude.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Attitude {
    /// Right wing down, rad.
    pub roll_rad: f64,
    /// Nose up, rad.
    pub pitch_rad: f64,
    /// True heading, rad, clockwise from north.
    pub heading_rad: f64,
    /// Body rates about x, y and z, rad/s.
    pub rates_radps: [f64; 3],
}

/// How the vehicle moves.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Motion {
    /// Where it is; none before that is known.
    pub position: Option<Position>,
    /// Over the ground, towards north and east, m/s.
    pub north_east_mps: [f64; 2],
    /// Upwards, m/s.
    pub climb_mps: f64,
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Towards north and east, m/s; none if it is not known.
    pub wind_mps: Option<[f64; 2]>,
    /// Standard deviation of the horizontal position, m; none if it is not known.
    pub position_uncertainty_m: Option<f64>,
}

/// A mode: what the vehicle does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Mode {
    /// Control is not held.
    #[default]
    Standby,
    /// Heading, altitude and airspeed are held.
    Hold,
    /// The timed pattern.
    Pattern,
    /// The plan, item by item.
    Plan,
    /// A circle, to wait.
    Loiter,
    /// To a commanded place.
    GoTo,
    /// Home.
    Return,
    /// On the runway, and away from it.
    Takeoff,
    /// On the glide path, and on the runway.
    Land,
    /// A landing is given up.
    GoAround,
    /// Without power.
    Glide,
}

/// What is flown, and where to.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Flight {
    /// The mode.
    pub mode: Mode,
    /// Whether control is held.
    pub is_engaged: bool,
    /// Whether it flies by a failsafe.
    pub is_failsafe: bool,
    /// Whether it is in the air.
    pub is_airborne: bool,
    /// The item of the plan that is flown, from 1; 0: none.
    pub item: u16,
    /// Demanded airspeed, m/s.
    pub airspeed_mps: f64,
    /// Demanded altitude above mean sea level, m.
    pub altitude_m: f64,
    /// Demanded roll, pitch and course, rad.
    pub roll_pitch_course_rad: [f64; 3],
    /// To the right of the path, m.
    pub cross_track_m: f64,
    /// To the next place, m.
    pub to_go_m: f64,
    /// Magnetic heading, rad.
    pub magnetic_heading_rad: f64,
    /// 0 idle, 1 full.
    pub throttle: f64,
}

/// Whether it is able to fly.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Health {
    /// Nothing inhibits engaging.
    pub may_engage: bool,
    /// Sensors that are there, and those of them that are not excluded.
    pub sensors: [Sensors; 2],
    /// Of the battery, V; none if it is not measured.
    pub battery_v: Option<f64>,
    /// What is left of its charge, 0 to 1; likewise.
    pub battery_charge: Option<f64>,
}

/// Kinds of sensors.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "a set of independent kinds")]
pub struct Sensors {
    /// Attitude and rates.
    pub inertial: bool,
    /// Pressure altitude.
    pub barometer: bool,
    /// Airspeed.
    pub airspeed: bool,
    /// Position.
    pub gnss: bool,
    /// Heading.
    pub compass: bool,
}

/// The newest of everything.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct VehicleState {
    /// A daemon is there, and this is its state.
    pub is_connected: bool,
    /// Its records have stopped: the state is an old one.
    pub is_old: bool,
    /// The attitude.
    pub attitude: Attitude,
    /// How it moves.
    pub motion: Motion,
    /// What is flown.
    pub flight: Flight,
    /// Whether it is able to.
    pub health: Health,
    /// Where it took off, or takes off.
    pub home: Option<Position>,
    /// The hash of its plan; 0: it has none.
    pub plan_hash: u64,
}

impl VehicleState {
    /// Whether it stands after a landing, and control is still held.
    pub(crate) fn has_landed(&self) -> bool {
        self.flight.is_engaged && !self.flight.is_airborne && self.flight.mode == Mode::Land
    }

    /// Whether it flies its mission.
    pub(crate) const fn flies_mission(&self) -> bool {
        let is_of_plan = matches!(
            self.flight.mode,
            Mode::Plan | Mode::Takeoff | Mode::Land | Mode::GoAround
        );
        self.flight.is_engaged && is_of_plan
    }
}

/// What the protocol wants done; answered by its ticket.
#[derive(Clone, PartialEq, Debug)]
pub struct Request {
    /// For the answer.
    pub ticket: u32,
    /// The link that it came by.
    pub link: LinkId,
    /// The numbers of system and component that ask.
    pub sender: (u8, u8),
    /// After this time it must not be carried out, ms of [`Now::ms`].
    pub deadline_ms: u64,
    /// What is to be done.
    pub action: Action,
}

/// What is to be done.
#[derive(Clone, PartialEq, Debug)]
pub enum Action {
    /// These commands, one after the other, until one is refused.
    Commands(Vec<Command>),
    /// Another plan, from this item on, which is counted from 1.
    Plan {
        /// The plan.
        plan: Box<fcc_plan::Plan>,
        /// The item that is flown first.
        item: u16,
    },
}

/// What became of a [`Request`]: the hash of the plan for a plan, or why it was refused.
pub type Outcome = Result<u64, String>;
