//! X-Plane, over its own UDP protocol, as a sensor and an actuator.
//!
//! [`XPlane::open`] gives an [`XPlaneSensor`] and an [`XPlaneActuator`] for a
//! loop. Reading needs no set-up in X-Plane's menus: values are subscribed
//! (RREF, RPOS) and sent to the port that requested them. For writing, X-Plane
//! 12 must accept incoming connections; this is checked by reading back what
//! was written, and [`XPlaneStatus::trouble`] says what to do.
//!
//! ```no_run
//! use fcc_xplane::{XPlane, XPlaneConfig};
//!
//! let (sensor, actuator) = XPlane::open(&XPlaneConfig::default())?;
//! let status = sensor.status();
//! // The loop owns `sensor` and `actuator`; `status` is used from outside.
//! if let Some(trouble) = status.trouble() {
//!     eprintln!("{trouble}");
//! }
//! # drop((sensor, actuator));
//! # Ok::<(), fcc_xplane::OpenError>(())
//! ```
//!
//! # Structure
//!
//! | module | contents |
//! |---|---|
//! | [`protocol`] | messages as bytes; no I/O |
//! | `quantity`, `rows`, `units` | which dataref or column is what, and in which unit |
//! | `simulator` | the simulator's clock compared with ours: [`SimulatorState`] |
//! | `inbox`, `values`, `sending_clock` | from datagrams to measurements |
//! | `motion`, `specific_force` | attitude, specific force and velocity from the local axes |
//! | `axial_load` | the sign of a row's axial load |
//! | `source_filter`, `reply_port`, `port_watch`, `udp_sockets`, `socket_diagnosis` | from which address and port of the simulator they are accepted |
//! | `subscriptions`, `missing` | what to request, when to repeat it, and what does not arrive |
//! | `traffic` | how much is sent to X-Plane |
//! | `engage_switch` | the dataref that engages |
//! | `controls`, `deflections`, `readbacks`, `confirmation`, `release_monitor`, `release` | writing, confirmation that it takes effect, release |
//! | `link`, `shared_address`, `counters` | what the sensor, the actuator and readers of the status share |
//! | `authority`, `status`, `reported`, `old_datagrams` | who has control, and the state of the connection, seen from outside the loop |
//! | `silence`, `no_answer` | why X-Plane does not answer |
//! | `address`, `port`, `discovery` | where it is, sockets, the beacon |
//!
//! # Faults that are handled
//!
//! Datagrams may be lost, duplicated, reordered, truncated or forged, and
//! X-Plane may be paused, slowed, restarted or killed. Truncated and corrupted
//! datagrams are left out and counted; duplicates change nothing; overtaken
//! ones are dropped by the flight time in them; those from another IP address,
//! or from another port than the one that has answered, are not even delivered
//! by the kernel; and at most a configured number is read in a tick. The flight
//! time is an f32: after 36 hours of one flight it counts in steps of 16 ms.
//!
//! In a tick nothing allocates, locks, logs or panics, and the only system
//! calls are to receive and to send, which do not wait.
#![forbid(unsafe_code)]

mod actuator;
mod address;
mod aircraft_state;
mod authority;
mod axial_load;
mod beacon_group;
mod config;
mod confirmation;
mod controls;
mod counters;
mod deflections;
mod discovery;
mod engage_switch;
mod inbox;
mod link;
mod missing;
mod motion;
mod no_answer;
mod old_datagrams;
mod open;
mod plant;
mod port;
mod port_watch;
mod pressure_altitude;
mod probe;
mod program;
pub mod protocol;
mod quantity;
mod readbacks;
mod release;
mod release_monitor;
mod reload_watch;
mod reply_port;
mod reported;
mod rows;
mod sending_clock;
mod sensor;
mod sent_yoke;
mod shared_address;
mod silence;
mod simulator;
mod socket_diagnosis;
mod source_filter;
mod specific_force;
mod status;
mod subscriptions;
mod traffic;
mod udp_port;
mod udp_sockets;
mod units;
mod values;

pub use actuator::XPlaneActuator;
pub use address::{AddressError, HostName, Simulator, USUAL_LOCAL_PORT, XPLANE_PORT};
pub use authority::XPlaneAuthority;
pub use config::{
    AxialLoad, DataRows, Input, Output, PlantKind, RowsVersion, XPlaneConfig, XPlaneConfigError,
};
pub use discovery::{DiscoverError, Found, discover};
pub use fcc_core::framework::{PlantId, Released};
pub use link::Control;
pub use missing::Missing;
pub use old_datagrams::OldDatagrams;
pub use open::{OpenError, XPlane};
pub use plant::plant_at;
pub use port::{Errno, Port};
pub use sensor::XPlaneSensor;
pub use simulator::SimulatorState;
pub use status::{Counts, Trouble, XPlaneStatus};
pub use udp_port::UdpPort;
