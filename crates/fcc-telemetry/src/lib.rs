//! What happened in a flight: its records and events, what is generated from
//! their declaration, how well the loop kept time, and the score.
//!
//! What is done with them is in crates above, none of which needs another's
//! libraries: `fcc-record` writes and reads files, `fcc-live` shares memory with
//! whoever watches, `fcc-report` makes tables and plots.
//!
//! Everything here runs outside the loop's thread, on the records that the
//! loop left behind.

mod flight;
mod instance;
mod message;
pub mod schema;
mod score;
mod timing;
pub mod units;

pub use flight::FlightLog;
pub use instance::{Instance, InstanceError};
pub use message::{FlightEvent, FlightMessage, FlightRecord, FlightWords, event_words};
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, ScoredBy, score};
pub use timing::{DeniedRequest, Lateness, Period, Realtime, TimingReport};
