//! Why a flight could not be assembled.

use std::io::{self, ErrorKind};

use fcc_sim::SimError;
use fcc_xplane::OpenError;

/// Why a flight could not be assembled.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The built-in aircraft is impossible.
    #[error("the built-in aircraft: {0}")]
    BuiltIn(#[from] SimError),
    /// The connection to X-Plane could not be opened.
    #[error("X-Plane: {0}")]
    XPlane(#[from] OpenError),
    /// The thread that reads a device could not be started.
    #[error(
        "cannot start the thread that reads {name}: {source}; free memory, or raise the limit of threads"
    )]
    Device {
        /// The device.
        name: String,
        /// The operating system's error.
        source: io::Error,
    },
    /// The configuration has the sensors of a phone, and the program runs on none.
    #[error(
        "a sensor is of the kind \"phone\", and this program has no phone: fly it in the Android app, \
         or list other sensors"
    )]
    NoPhone,
    /// The link to the servo board could not be opened.
    #[error("servo board: {0}")]
    ServoBoard(#[from] fcc_servo_link::OpenError),
}

impl AssemblyError {
    /// Whether another program has the local port, or that of the beacons.
    pub fn is_taken(&self) -> bool {
        matches!(
            self,
            Self::XPlane(OpenError::Bind { source, .. } | OpenError::Beacon { source, .. })
                if source.kind() == ErrorKind::AddrInUse
        )
    }
}
