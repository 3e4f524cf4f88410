//! A second process that outlives this one by a moment, to give X-Plane's
//! controls back if this one is killed.
//!
//! X-Plane never takes an override back by itself, and a process that is
//! killed can do nothing more. So before a flight, this program starts itself
//! again as `fccd guard`, which waits at the end of a pipe. The pipe tells it
//! where control is held, and closes when this process ends, however it does;
//! if control was held by then, the guard centres the surfaces and releases
//! the overrides, until X-Plane shows that it did, or until a daemon that takes
//! control itself [relieves](super::relief) it.

use std::io::{self, BufRead, Write};
use std::net::SocketAddr;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use fcc_xplane::{OpenError, Released, XPlane, XPlaneConfig};

use super::relief::Post;
use crate::config::XPlaneSection;

/// Begins a line that says where control is held.
const HELD: &str = "held ";
/// Says that control is nobody's of ours.
const FREE: &str = "free";
/// How long a guard goes on trying: a simulator that loads scenery hangs for a
/// while.
const PATIENCE: Duration = Duration::from_secs(120);

/// The guard, as the process that it guards sees it.
pub(super) struct Guard {
    child: Child,
    held: Option<SocketAddr>,
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
        Ok(Self { child, held: None })
    }

    /// Says where control is held, if it is. A guard that is gone is no reason
    /// to stop.
    pub(super) fn tell(&mut self, held: Option<SocketAddr>) {
        if self.held == held {
            return;
        }
        self.held = held;
        if let Some(pipe) = &mut self.child.stdin {
            let _ = match held {
                Some(simulator) => writeln!(pipe, "{HELD}{simulator}"),
                None => writeln!(pipe, "{FREE}"),
            };
        }
    }

    /// Lets the guard go, and waits until it is gone.
    pub(super) fn dismiss(mut self) {
        self.tell(None);
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// Stands guard: reads `from` until it ends, and then gives back what is held.
/// Returns where, and how that ended.
///
/// # Errors
/// When what is read makes no sense, or there is no socket to be had.
pub fn run_release_helper(
    from: impl BufRead,
) -> Result<Option<(SocketAddr, Released)>, ReleaseHelperError> {
    let mut lines = from.lines();
    let first = lines.next().ok_or(ReleaseHelperError::Nothing)??;
    let section: XPlaneSection = serde_json::from_str(&first)?;
    let mut held: Option<SocketAddr> = None;
    // A pipe that breaks is a pipe that ends.
    for line in lines.map_while(Result::ok) {
        if line == FREE {
            held = None;
        } else if let Some(address) = line.strip_prefix(HELD) {
            held = address.parse().ok().or(held);
        }
    }
    let Some(simulator) = held else {
        return Ok(None);
    };
    let mut post = Post::at(simulator);
    let config = XPlaneConfig::from(&section);
    let released = XPlane::release_unless(&config, simulator, PATIENCE, || post.is_relieved())?;
    Ok(Some((simulator, released)))
}

/// Why a guard could not do its work.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum ReleaseHelperError {
    /// Nothing came through the pipe.
    #[error("fccd guard is started by fccd itself, which tells it what to guard")]
    Nothing,
    /// The pipe broke before it said anything.
    #[error("standard input: {0}")]
    Input(#[from] io::Error),
    /// The first line is not a configuration.
    #[error("the first line is no [x-plane] section as JSON: {0}")]
    Section(#[from] serde_json::Error),
    /// There is no socket to be had.
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
        format!("{section}\nheld {at}\n{last}")
    }

    fn simulator() -> UdpSocket {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket
            .set_read_timeout(Some(Duration::from_millis(300)))
            .unwrap();
        socket
    }

    /// Answers as X-Plane's layouts say: DREF is five bytes, an f32, the path;
    /// RREF five bytes, frequency, index, the path; its reply five bytes, then
    /// pairs of index and f32.
    fn answer(simulator: &UdpSocket, deaf_for: u32) -> f32 {
        let mut joystick = 1.0_f32;
        let mut bytes = [0; 600];
        let mut written = 0;
        while let Ok((length, from)) = simulator.recv_from(&mut bytes) {
            let text = String::from_utf8_lossy(&bytes[..length]).into_owned();
            if text.starts_with("DREF") && text.contains("override_joystick") {
                written += 1;
                if written > deaf_for {
                    joystick = f32::from_le_bytes(bytes[5..9].try_into().unwrap());
                }
            }
            if text.starts_with("RREF") && bytes[5..9] != [0; 4] {
                let value = if text.contains("override_joystick") {
                    joystick
                } else {
                    0.0
                };
                let mut reply = b"RREF,".to_vec();
                reply.extend(&bytes[9..13]);
                reply.extend(value.to_le_bytes());
                simulator.send_to(&reply, from).unwrap();
            }
        }
        joystick
    }

    #[test]
    fn a_pipe_that_just_ends_gives_the_controls_back_until_it_shows() {
        for deaf_for in [0, 3] {
            let simulator = simulator();
            let script = script(&simulator, "");
            let guard = std::thread::spawn(move || run_release_helper(script.as_bytes()).unwrap());
            assert!(answer(&simulator, deaf_for).abs() < 0.5);
            let (_, released) = guard.join().unwrap().unwrap();
            assert_eq!(released, Released::Confirmed);
        }
    }

    #[test]
    fn what_is_free_is_left_alone() {
        let simulator = simulator();
        let told = run_release_helper(script(&simulator, "free\n").as_bytes()).unwrap();
        assert_eq!(told, None);
        assert!(simulator.recv(&mut [0; 600]).is_err(), "something was sent");
    }

    #[test]
    fn a_simulator_that_is_gone_holds_nothing() {
        let simulator = simulator();
        let script = script(&simulator, "");
        drop(simulator);
        let (_, released) = run_release_helper(script.as_bytes()).unwrap().unwrap();
        assert_eq!(released, Released::Gone);
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        let error = run_release_helper("what?\n".as_bytes()).unwrap_err();
        assert!(error.to_string().contains("[x-plane]"), "{error}");
        assert!(matches!(
            run_release_helper(&b""[..]),
            Err(ReleaseHelperError::Nothing)
        ));
    }
}
