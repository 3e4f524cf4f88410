//! X-Plane, over its own UDP protocol, as a sensor and an actuator.
//!
//! [`XPlane::open`] gives an [`XPlaneSensor`] and an [`XPlaneActuator`] that a
//! loop holds like any others. Nothing needs to be set up in X-Plane's menus
//! to read from it: values are subscribed (RREF, RPOS) and come back to the
//! port that asked. To write, X-Plane 12 must accept incoming connections;
//! whether it does is found out by reading back what was written, and
//! [`XPlaneStatus::trouble`] says in words what to do.
//!
//! ```no_run
//! use fcc_xplane::{XPlane, XPlaneConfig};
//!
//! let (sensor, actuator) = XPlane::open(&XPlaneConfig::default())?;
//! let status = sensor.status();
//! // The loop takes `sensor` and `actuator`; `status` stays here.
//! if let Some(trouble) = status.trouble() {
//!     eprintln!("{trouble}");
//! }
//! # drop((sensor, actuator));
//! # Ok::<(), fcc_xplane::OpenError>(())
//! ```
//!
//! # How it fits together
//!
//! | module | what it knows |
//! |---|---|
//! | [`protocol`] | messages as bytes; no I/O |
//! | `quantity`, `rows`, `units`, `specific_force` | which dataref or column is what, and in which unit |
//! | `simulator` | the simulator's clock against ours: [`SimulatorState`] |
//! | `inbox`, `values` | from datagrams to measurements |
//! | `subscriptions`, `missing` | what to ask for, when again, and what never comes |
//! | `controls`, `confirmation`, `release_monitor`, `release` | writing, whether it takes effect, giving back |
//! | `authority`, `status` | who has control, and how the connection is, seen from outside the loop |
//! | `address`, `port`, `discovery` | where it is, sockets, the beacon |
//!
//! # What may go wrong out there
//!
//! Datagrams are lost, doubled, reordered, cut and forged, and X-Plane is
//! paused, slowed, restarted and killed. Cut and garbled ones are left out and
//! counted; doubled ones change nothing; overtaken ones are dropped by the
//! flight time in them; those from another IP address are dropped; and at most
//! a configured number is read in a tick. The flight time is an f32: after 36
//! hours of one flight it counts in steps of 16 ms.
//!
//! In a tick nothing allocates, locks, logs or panics, and the only system
//! calls are to receive and to send, which do not wait.
#![forbid(unsafe_code)]

mod actuator;
mod address;
mod authority;
mod config;
mod confirmation;
mod controls;
mod discovery;
mod inbox;
mod link;
mod missing;
mod open;
mod port;
pub mod protocol;
mod quantity;
mod release;
mod release_monitor;
mod rows;
mod scratch_port;
mod sensor;
mod simulator;
mod specific_force;
mod status;
mod subscriptions;
mod units;
mod values;

pub use actuator::XPlaneActuator;
pub use address::{AddressError, HostName, Simulator};
pub use authority::XPlaneAuthority;
pub use config::{
    DataRows, Input, Output, RowsVersion, XPLANE_PORT, XPlaneConfig, XPlaneConfigError,
};
pub use discovery::{DiscoverError, Found, discover};
pub use fcc_core::framework::Released;
pub use link::Control;
pub use missing::Missing;
pub use open::{OpenError, XPlane};
pub use port::{Errno, Port, UdpPort};
pub use sensor::XPlaneSensor;
pub use simulator::SimulatorState;
pub use status::{Counts, Trouble, XPlaneStatus};
