//! What happens, live: each record and event in shared memory, for whoever
//! watches.
//!
//! The daemon hands what its loop tells to a [`Publisher`], which never waits;
//! a thread of its own, `fcc-live`, puts it into shared memory by iceoryx2. The
//! loop's thread does not know that this exists: a watcher that joins, leaves,
//! hangs or is killed costs it nothing.
//!
//! Whoever watches opens a [`Watcher`]; programs in other languages read the
//! same services by the layouts in `docs/telemetry.md`:
//!
//! | service | what | history |
//! |---|---|---|
//! | `fcc/INSTANCE/info` | [`Info`]: who publishes, in which layout | 1 |
//! | `fcc/INSTANCE/record/v2` | the record of each tick | 1 |
//! | `fcc/INSTANCE/event/v2` | [`Event`]: what happened once | 64 |
//! | `fcc/INSTANCE/status/v2` | [`Status`]: each second, how the run stands | 1 |
//!
//! Commands come in the other way: a [`Commander`] asks by the service
//! `fcc/INSTANCE/command/v2`, and learns what became of it.
//!
//! The layout of `info` never changes, so that a reader of another version can
//! say what it found. Everything else bears a version: [`LAYOUT`].

mod command;
mod error;
mod event;
mod info;
mod lateness;
mod place;
mod publisher;
mod record;
mod services;
mod space;
mod status;
mod text;
mod thread;
mod watcher;

pub use command::{
    Asked, COMMANDS_VERSION, CommandError, Commander, FlightCommand, NewSetpoints, OutsideLimits,
    Quantity, Unflyable, Verdict,
};
pub use error::{PublishError, WatchError};
pub use event::{Event, EventCode};
pub use info::Info;
pub use lateness::{LATENESS_BOUNDS_NS, LatenessCounts};
#[cfg(feature = "flight")]
pub use publisher::Publisher;
pub use publisher::PublisherOf;
pub use services::{EVENT_HISTORY, MAX_WATCHERS, RECORD_BUFFER};
pub use status::{RecorderState, RecorderStatus, Status};
pub use text::Text;
#[cfg(feature = "flight")]
pub use watcher::Watcher;
pub use watcher::WatcherOf;

/// The version of all layouts but [`Info`]'s. Whoever changes one of them,
/// a field's meaning included, counts this up.
pub const LAYOUT: u32 = 2;
