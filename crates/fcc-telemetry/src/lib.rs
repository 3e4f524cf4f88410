//! What happened: the records of a flight, its score, a run's timing, and
//! tables of both.
//!
//! Everything here runs outside the loop's thread, on the records that the
//! loop left behind.

mod flight;
mod instance;
#[cfg(feature = "live")]
pub mod live;
mod message;
mod score;
mod table;
mod timing;

pub use flight::FlightLog;
pub use instance::{Instance, InstanceError};
pub use message::{FlightEvent, FlightMessage, FlightRecord};
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, score};
pub use table::{flight_table, timing_table};
pub use timing::{Lateness, Period, Realtime, RefusedWish, TimingReport};
