//! The control framework: the part that is common to all plants, from an
//! aircraft to a room.
//!
//! In each [`Tick`] a loop wakes, lets each [`Sensor`] write its part of the
//! measurements, steps a [`Controller`] and passes the outputs to each
//! [`Actuator`]. The [`State`] of the loop follows one transition table
//! ([`State::after`]). What happened in a tick is its [`Record`]; what happened
//! once is an [`Event`]. The loop itself is in `fcc-runtime`; this module has
//! its components and the types they exchange.

mod actuator;
mod authority;
mod command;
mod controller;
mod event;
mod event_description;
mod index_sets;
mod message;
mod notice;
mod plant_id;
mod reading;
mod record;
pub mod schema;
mod sensor;
mod source_clock;
mod sources;
mod stage;
mod state;
mod state_code;
mod tick;
mod time;

pub use actuator::{Actuator, ActuatorFault};
pub use authority::{ControlAuthority, Released, TakeoverNotice};
pub use command::LoopCommand;
pub use controller::{Controller, Switch};
pub use event::{Event, EventKind, EventOf};
pub use event_description::EventDescription;
pub use index_sets::{Flags, ReadingSet, SensorSet};
pub use message::{Message, MessageOf};
pub use notice::{Notice, PERMILLE};
pub use plant_id::PlantId;
pub use reading::Reading;
pub use record::{Record, RecordOf, StageTimes};
pub use sensor::{FALLBACK_AFTER, Sensor, SensorFault};
pub use source_clock::SourceClock;
pub use sources::{Preference, Preferred, Readings, SourceChange, Sources};
pub use stage::Stage;
pub use state::{AfterRelease, Cause, Input, State};
pub use state_code::StateCode;
pub use tick::Tick;
pub use time::{ROUNDING_S, Time};
