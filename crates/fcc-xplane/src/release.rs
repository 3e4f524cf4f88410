//! Giving control back from outside a loop, and waiting until it is really
//! back: at the end of a program, and for who survives one that was killed.

use std::io::ErrorKind;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use fcc_core::framework::Released;

use crate::config::XPlaneConfig;
use crate::controls::Controls;
use crate::open::{OpenError, XPlane};
use crate::port::{Errno, any_address};
use crate::protocol::rref;
use crate::quantity::{OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES};

/// Between one letting go and the next.
const AGAIN_AFTER: Duration = Duration::from_millis(250);
/// How long one wait for an answer is.
const LISTEN_FOR: Duration = Duration::from_millis(20);
/// So many refusals in a row, and nobody is there.
const REFUSALS: u32 = 4;
/// How often the read-back is asked for, Hz.
const READ_BACK_HZ: u16 = 20;
/// The indices of the read-back, far from those of a sensor's subscriptions.
const INDICES: [i32; 2] = [9_001, 9_002];

impl XPlane {
    /// Centres the surfaces and releases the overrides at `simulator`, whoever
    /// set them, until X-Plane shows them released or `patience` ends. Waits:
    /// not for a loop.
    ///
    /// X-Plane never takes an override back on its own, and one that hangs
    /// loses what is sent to it: sending once is no release.
    ///
    /// # Errors
    /// When the configuration is refused or there is no socket to be had.
    pub fn release_and_wait(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        patience: Duration,
    ) -> Result<Released, OpenError> {
        Self::release_unless(config, simulator, patience, || false)
    }

    /// The same, unless it is called off: `is_called_off` is asked every 20 ms
    /// or sooner, and before anything is sent.
    ///
    /// # Errors
    /// As [`release_and_wait`](Self::release_and_wait).
    pub fn release_unless(
        config: &XPlaneConfig,
        simulator: SocketAddr,
        patience: Duration,
        is_called_off: impl FnMut() -> bool,
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
            retry_until_released(&socket, &mut controls, &requests, patience, is_called_off);
        for request in &mut requests {
            rref::set_frequency(request, 0);
            let _ = socket.send(request);
        }
        Ok(outcome)
    }
}

fn connect(simulator: SocketAddr) -> std::io::Result<UdpSocket> {
    let socket = UdpSocket::bind((any_address(simulator.ip()), 0))?;
    // Connected, so that the system tells of a port where nobody listens.
    socket.connect(simulator)?;
    socket.set_read_timeout(Some(LISTEN_FOR))?;
    Ok(socket)
}

fn retry_until_released(
    socket: &UdpSocket,
    controls: &mut Controls,
    requests: &[[u8; rref::REQUEST_BYTES]; 2],
    patience: Duration,
    mut is_called_off: impl FnMut() -> bool,
) -> Released {
    let begun = Instant::now();
    let mut sent: Option<Instant> = None;
    let mut refusals = 0;
    // What each override shows, since the letting go was last sent.
    let mut shown: [Option<bool>; 2] = [None; 2];
    let mut datagram = [0; 2_048];
    while begun.elapsed() < patience {
        if is_called_off() {
            return Released::CalledOff;
        }
        if sent.is_none_or(|at| at.elapsed() >= AGAIN_AFTER) {
            sent = Some(Instant::now());
            shown = [None; 2];
            let _ = controls.let_go(|bytes| send(socket, bytes));
            for request in requests {
                let _ = socket.send(request);
            }
        }
        match socket.recv(&mut datagram) {
            Ok(length) => {
                refusals = 0;
                read_back(datagram.get(..length).unwrap_or_default(), &mut shown);
            }
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => refusals += 1,
            Err(_) => {}
        }
        if shown == [Some(false); 2] {
            return Released::Confirmed;
        }
        if refusals >= REFUSALS {
            return Released::Gone;
        }
    }
    Released::Unconfirmed
}

/// Notes what a reply shows; what was sent before the requests has other
/// indices and is passed over.
fn read_back(datagram: &[u8], shown: &mut [Option<bool>; 2]) {
    let Ok(pairs) = rref::parse(datagram) else {
        return;
    };
    for (index, value) in pairs {
        for (place, of) in shown.iter_mut().zip(INDICES) {
            if index == of && value.is_finite() {
                *place = Some(value >= 0.5);
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
