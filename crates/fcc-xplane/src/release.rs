//! Releasing control from outside a loop, and waiting for confirmation: at the
//! end of a program, and on behalf of a program that was killed.

use std::io::ErrorKind;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use fcc_core::framework::Released;

use crate::config::XPlaneConfig;
use crate::controls::Controls;
use crate::open::{OpenError, XPlane};
use crate::port::Errno;
use crate::protocol::rref;
use crate::quantity::{OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES};
use crate::udp_port::any_address;

/// The interval between two releases.
const AGAIN_AFTER: Duration = Duration::from_millis(250);
/// The receive timeout.
const LISTEN_FOR: Duration = Duration::from_millis(20);
/// After this many refusals in a row the simulator counts as unreachable.
const REFUSALS: u32 = 4;
/// The rate at which the readback is requested, Hz.
const READ_BACK_HZ: u16 = 20;
/// The indices of the readback, distinct from those of a sensor's
/// subscriptions.
const INDICES: [i32; 2] = [9_001, 9_002];

impl XPlane {
    /// Centres the surfaces and clears the overrides at `simulator`, whichever
    /// program set them, until X-Plane confirms it or `timeout` has passed.
    /// This waits, so do not call it in a loop.
    ///
    /// X-Plane never clears an override by itself, and an X-Plane that hangs
    /// loses what is sent to it, so sending once is not enough.
    ///
    /// # Errors
    /// When the configuration is refused or no socket can be opened.
    pub fn release_and_wait(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        timeout: Duration,
    ) -> Result<Released, OpenError> {
        Self::release_unless_cancelled(config, simulator, timeout, || false)
    }

    /// The same, unless it is cancelled: `is_cancelled` is called at least
    /// every 20 ms, and before anything is sent.
    ///
    /// # Errors
    /// As [`release_and_wait`](Self::release_and_wait).
    pub fn release_unless_cancelled(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        timeout: Duration,
        is_cancelled: impl FnMut() -> bool,
    ) -> Result<Released, OpenError> {
        config.validate()?;
        let socket = connect(simulator).map_err(|source| OpenError::Bind { port: 0, source })?;
        let mut controls = Controls::new(config)?;
        let mut requests = [[0; rref::REQUEST_BYTES]; 2];
        let paths = [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES];
        for ((request, index), path) in requests.iter_mut().zip(INDICES).zip(paths) {
            rref::request(request, READ_BACK_HZ, index, path)?;
        }
        let outcome =
            retry_until_released(&socket, &mut controls, &requests, timeout, is_cancelled);
        for request in &mut requests {
            rref::set_frequency(request, 0);
            let _ = socket.send(request);
        }
        Ok(outcome)
    }
}

fn connect(simulator: SocketAddr) -> std::io::Result<UdpSocket> {
    let socket = UdpSocket::bind((any_address(simulator.ip()), 0))?;
    // Connected, so that the system reports a closed port.
    socket.connect(simulator)?;
    socket.set_read_timeout(Some(LISTEN_FOR))?;
    Ok(socket)
}

fn retry_until_released(
    socket: &UdpSocket,
    controls: &mut Controls,
    requests: &[[u8; rref::REQUEST_BYTES]; 2],
    timeout: Duration,
    mut is_cancelled: impl FnMut() -> bool,
) -> Released {
    let begun = Instant::now();
    let mut sent: Option<Instant> = None;
    let mut refusals = 0;
    // The readback of each override since the release was last sent.
    let mut readback: [Option<bool>; 2] = [None; 2];
    let mut datagram = [0; 2_048];
    while begun.elapsed() < timeout {
        if is_cancelled() {
            return Released::Cancelled;
        }
        if sent.is_none_or(|at| at.elapsed() >= AGAIN_AFTER) {
            sent = Some(Instant::now());
            readback = [None; 2];
            let _ = controls.release(|bytes| send(socket, bytes));
            for request in requests {
                let _ = socket.send(request);
            }
        }
        match socket.recv(&mut datagram) {
            Ok(length) => {
                refusals = 0;
                read_back(datagram.get(..length).unwrap_or_default(), &mut readback);
            }
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => refusals += 1,
            Err(_) => {}
        }
        if readback == [Some(false); 2] {
            return Released::Confirmed;
        }
        if refusals >= REFUSALS {
            return Released::Unreachable;
        }
    }
    Released::Unconfirmed
}

/// Stores the readback in a reply; values sent before the requests have other
/// indices and are ignored.
fn read_back(datagram: &[u8], readback: &mut [Option<bool>; 2]) {
    let Ok(pairs) = rref::parse(datagram) else {
        return;
    };
    for (index, value) in pairs {
        for (slot, of) in readback.iter_mut().zip(INDICES) {
            if index == of && value.is_finite() {
                *slot = Some(value >= 0.5);
            }
        }
    }
}

fn send(socket: &UdpSocket, bytes: &[u8]) -> Result<(), Errno> {
    socket
        .send(bytes)
        .map(|_| ())
        .map_err(|error| error.raw_os_error().unwrap_or(0))
}
