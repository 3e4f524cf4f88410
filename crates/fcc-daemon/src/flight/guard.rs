//! A second process that outlives this one by a moment, to give X-Plane's
//! controls back if this one is killed.
//!
//! X-Plane never takes an override back by itself, and a process that is
//! killed can do nothing more. So before a flight, this program starts itself
//! again as `fccd guard`, which waits at the end of a pipe. The pipe closes
//! when this process ends, however it does; unless it said `done` before, the
//! guard centres the surfaces and releases the overrides.

use std::io::{self, BufRead, Write};
use std::net::SocketAddrV4;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};

use fcc_xplane::{OpenError, XPlane, XPlaneConfig};

use crate::config::XPlaneSection;

/// The word by which a flight that gave its controls back lets the guard go.
const DONE: &str = "done";
/// Begins a line that says where X-Plane is.
const AT: &str = "at ";

/// The guard, as the process that it guards sees it.
pub(super) struct Guard {
    child: Child,
    told: Option<SocketAddrV4>,
}

impl Guard {
    /// Starts the guard.
    ///
    /// # Errors
    /// When this program cannot be started a second time.
    pub(super) fn start(section: &XPlaneSection) -> io::Result<Self> {
        let mut child = Command::new(std::env::current_exe()?)
            .arg("guard")
            // A group of its own: Ctrl-C is not for it.
            .process_group(0)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()?;
        let line = serde_json::to_string(section)?;
        if let Some(pipe) = &mut child.stdin {
            writeln!(pipe, "{line}")?;
        }
        Ok(Self { child, told: None })
    }

    /// Says where X-Plane is. A guard that is gone is no reason to stop.
    pub(super) fn tell(&mut self, simulator: SocketAddrV4) {
        if self.told == Some(simulator) {
            return;
        }
        self.told = Some(simulator);
        if let Some(pipe) = &mut self.child.stdin {
            let _ = writeln!(pipe, "{AT}{simulator}");
        }
    }

    /// Lets the guard go: the controls were given back.
    pub(super) fn dismiss(mut self) {
        if let Some(mut pipe) = self.child.stdin.take() {
            let _ = writeln!(pipe, "{DONE}");
        }
        let _ = self.child.wait();
    }
}

/// Stands guard: reads `from` until it ends, and then gives the controls back
/// unless told otherwise. Returns where it did.
///
/// # Errors
/// When what is read makes no sense, or nothing can be sent.
pub fn stand_guard(from: impl BufRead) -> Result<Option<SocketAddrV4>, GuardError> {
    let mut lines = from.lines();
    let first = lines.next().ok_or(GuardError::Nothing)??;
    let section: XPlaneSection = serde_json::from_str(&first)?;
    let mut simulator = None;
    for line in lines {
        // A pipe that breaks is a pipe that ends.
        let Ok(line) = line else { break };
        if line == DONE {
            return Ok(None);
        }
        if let Some(address) = line.strip_prefix(AT) {
            simulator = address.parse().ok().or(simulator);
        }
    }
    if let Some(simulator) = simulator {
        XPlane::release_after_crash(&XPlaneConfig::from(&section), simulator)?;
    }
    Ok(simulator)
}

/// Why a guard could not do its work.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum GuardError {
    /// Nothing came through the pipe.
    #[error("fccd guard is started by fccd itself, which tells it what to guard")]
    Nothing,
    /// The pipe broke before it said anything.
    #[error("standard input: {0}")]
    Input(#[from] io::Error),
    /// The first line is not a configuration.
    #[error("the first line is no [x-plane] section as JSON: {0}")]
    Section(#[from] serde_json::Error),
    /// Nothing could be sent.
    #[error(transparent)]
    Release(#[from] OpenError),
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;
    use std::time::Duration;

    use super::*;

    fn script(simulator: &UdpSocket, last: &str) -> String {
        let section = serde_json::to_string(&XPlaneSection::default()).unwrap();
        let at = simulator.local_addr().unwrap();
        format!("{section}\nat {at}\n{last}")
    }

    fn simulator() -> UdpSocket {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket
            .set_read_timeout(Some(Duration::from_millis(300)))
            .unwrap();
        socket
    }

    /// DREF: five bytes, an f32, then the path (X-Plane's layout).
    #[test]
    fn a_pipe_that_just_ends_gives_the_controls_back() {
        let simulator = simulator();
        let told = stand_guard(script(&simulator, "").as_bytes()).unwrap();
        assert!(told.is_some());
        let mut released = false;
        let mut bytes = [0; 600];
        while let Ok(length) = simulator.recv(&mut bytes) {
            let value = f32::from_le_bytes(bytes[5..9].try_into().unwrap());
            let path = String::from_utf8_lossy(&bytes[9..length]);
            released |=
                path.starts_with("sim/operation/override/override_joystick\0") && value == 0.0;
        }
        assert!(released);
    }

    #[test]
    fn done_means_done() {
        let simulator = simulator();
        let told = stand_guard(script(&simulator, "done\n").as_bytes()).unwrap();
        assert_eq!(told, None);
        assert!(simulator.recv(&mut [0; 600]).is_err(), "something was sent");
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        let error = stand_guard("what?\n".as_bytes()).unwrap_err();
        assert!(error.to_string().contains("[x-plane]"), "{error}");
        assert!(matches!(stand_guard(&b""[..]), Err(GuardError::Nothing)));
    }
}
