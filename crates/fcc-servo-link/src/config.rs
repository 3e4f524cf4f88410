//! How a servo board is reached.

use core::time::Duration;
use std::path::PathBuf;

use fcc_xplane::{Output, PlantKind, Simulator, XPlaneConfig};

use crate::tty::Baud;

/// How a servo board is reached, and when it counts as silent.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ServoBoardConfig {
    /// The way to it. Default: UDP to 192.168.4.1:49000, the address that a Wi-Fi
    /// module usually gives itself as an access point.
    pub link: Link,
    /// The dataref of the engage switch, as the board calls it. Default: that of
    /// X-Plane.
    pub engage_switch: String,
    /// The board counts as silent after this long without a message. Default: 500
    /// ms.
    pub silent_after: Duration,
    /// Where a loop has several sensors of a quantity, another one is preferred
    /// after this long without a reading. Default: 100 ms, five replies.
    pub fallback_after: Duration,
    /// `SCHED_FIFO` with this priority for the thread that serves a serial line,
    /// 1..=98, if it is granted: below the loop's, and above all without one.
    /// Default: none.
    pub priority: Option<u8>,
}

/// The way to a servo board.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Link {
    /// A datagram for each message, to this address.
    Udp(Simulator),
    /// A frame for each message, on a serial line: 8 data bits, no parity, 1 stop
    /// bit, no flow control.
    Serial {
        /// The device, such as `/dev/ttyUSB0`.
        path: PathBuf,
        /// Its speed.
        baud: Baud,
    },
}

impl Default for ServoBoardConfig {
    fn default() -> Self {
        let x_plane = XPlaneConfig::default();
        Self {
            link: Link::Udp(Simulator::At(([192, 168, 4, 1], 49_000).into())),
            engage_switch: x_plane.engage_switch,
            silent_after: x_plane.silent_after,
            fallback_after: x_plane.fallback_after,
            priority: None,
        }
    }
}

impl ServoBoardConfig {
    /// That of the adapter for X-Plane's messages.
    pub(crate) fn x_plane(&self, board: Simulator) -> XPlaneConfig {
        XPlaneConfig {
            simulator: board,
            plant: PlantKind::ServoBoard,
            // It answers from the port that it listens on.
            reply_port: 0,
            output: Output::Data,
            engage_switch: self.engage_switch.clone(),
            silent_after: self.silent_after,
            fallback_after: self.fallback_after,
            ..XPlaneConfig::default()
        }
    }
}
