//! Live telemetry: each record and event in shared memory, for other programs.
//!
//! The daemon passes the loop's messages to a [`Publisher`], which never waits;
//! its thread, `fcc-live`, puts them into shared memory with iceoryx2. Watchers
//! that join, leave, hang or are killed have no effect on the loop's thread.
//!
//! A program opens a [`Watcher`], or for any plant a [`RowWatcher`]; programs in other languages read the same
//! services by the layouts in `docs/telemetry.md`:
//!
//! | service | what | history |
//! |---|---|---|
//! | `fcc/INSTANCE/info` | [`Info`]: who publishes, in which layout | 1 |
//! | `fcc/INSTANCE/columns/v2` | the columns of a record | 1 |
//! | `fcc/INSTANCE/record/v2` | the record of each tick | 1 |
//! | `fcc/INSTANCE/event/v2` | [`Event`]: what happened once | 64 |
//! | `fcc/INSTANCE/status/v2` | [`Status`]: each second, how the run stands | 1 |
//!
//! Commands are sent the other way: a [`Commander`] uses the service
//! `fcc/INSTANCE/command/v2` and receives the result.
//!
//! The layout of `info` never changes, so that a reader of another version can
//! report what it found. Everything else has a version: [`LAYOUT`].

mod command;
mod error;
mod event;
mod info;
mod item;
mod lateness;
mod place;
mod publisher;
mod row_watcher;
mod services;
mod shared_types;
mod space;
mod status;
mod text;
mod thread;
mod watcher;

pub use command::{
    COMMANDS_VERSION, Command, CommandError, Commandable, CommandableSetpoint, Commander,
    InvalidCommand, OutsideLimits, PendingCommand, PlantLimits, SentCommands, Verdict,
};
pub use error::{PublishError, WatchError};
pub use event::{Event, EventCode};
pub use info::Info;
pub use lateness::{LATENESS_BOUNDS_NS, LatenessCounts};
#[cfg(feature = "flight")]
pub use publisher::Publisher;
pub use publisher::PublisherOf;
pub use row_watcher::RowWatcher;
pub use services::{EVENT_HISTORY, MAX_WATCHERS, RECORD_BUFFER};
pub use status::{RecorderState, RecorderStatus, Status};
pub use text::Text;
#[cfg(feature = "flight")]
pub use watcher::Watcher;
pub use watcher::WatcherOf;

/// The version of all layouts except [`Info`]'s. Increase it with every change
/// of one of them, or of a field's meaning.
pub const LAYOUT: u32 = 2;
