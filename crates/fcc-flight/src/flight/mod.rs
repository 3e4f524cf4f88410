//! Assembles a flight from a configuration, and flies it.
//!
//! The loop runs in its own thread and is independent of this module. This
//! module reads its messages, passes them to each [`Observer`], and collects
//! the [`Outcome`]. What only the host program can do is done by its [`Host`].

mod assemble;
mod assembly_error;
mod calibrated;
mod check_controls;
#[cfg(any(test, feature = "conformance"))]
pub mod conformance;
mod control_override;
mod device;
pub(crate) mod event_log;
mod flapping;
mod fly;
mod follow;
mod ground;
pub(crate) mod hang;
mod host;
#[cfg(feature = "fault-injection")]
mod injection;
mod limits;
mod line_watch;
#[cfg(feature = "live")]
pub(crate) mod live;
pub(crate) mod monitor;
mod observer;
pub(crate) mod observer_list;
mod observers;
#[cfg(feature = "live")]
mod other_users;
mod outcome;
mod phone;
mod pilot;
mod plan;
#[cfg(feature = "live")]
mod plan_reader;
pub(crate) mod recording;
mod restart;
pub(crate) mod run_statistics;
mod scorer;
mod servos;
pub(crate) mod truth_recorder;

pub use assemble::{Assembly, assemble, assemble_on_phone, authority_without_connection};
pub use assembly_error::AssemblyError;
pub use check_controls::{Checked, Movement, Unchecked, Verdict, check_controls};
pub use control_override::ControlOverride;
pub(crate) use device::open_device;
pub use flapping::Flapping;
pub use fly::{FlyError, fly};
pub use ground::Impact;
pub use host::Host;
#[cfg(feature = "fault-injection")]
pub use injection::{allocate_in_loop, loop_allocator_calls};
pub use limits::setpoint_limits;
pub use observer::{Access, Facts, FlightTime, Observer, Report, Reports};
#[cfg(feature = "live")]
pub use other_users::{OtherUserError, command_another_users, command_of};
#[cfg(all(fuzzing, feature = "live"))]
pub use other_users::{answer_as_received, line_of_parts};
pub use outcome::{Conclusion, EventEntry, Figure, Outcome, RecordingOutcome};
pub use phone::{OpenPhone, PhoneHost};
pub use pilot::Pilot;
pub use plan::{Length, Pace, Plan};
pub use recording::{RecordingRequest, about};
#[cfg(fuzzing)]
pub use restart::read_state;
pub use scorer::true_sample;
