//! A second process that outlives this one by a moment, to give the
//! controls back if this one is killed.
//!
//! A simulator never takes its controls back by itself, and a process that is
//! killed can do nothing more. So before a flight, this program starts itself
//! again as `fccd guard`, which waits at the end of a pipe. The pipe tells it
//! where control is held, and closes when this process ends, however it does;
//! if control was held by then, the guard gives it back, until the
//! plant shows that it has it, or until a daemon that takes
//! control itself [relieves](super::relief) it.

use std::io::{self, BufRead, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use fcc_core::framework::{ActuatorFault, PlantId, Released};
use fcc_flight::config::{Config, ConfigError};
use fcc_flight::flight::authority_without_connection;

use super::relief::Post;

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
    held: Option<PlantId>,
}

impl Guard {
    /// Starts the guard.
    ///
    /// # Errors
    /// When this program cannot be started a second time.
    pub(super) fn start(config: &Config) -> io::Result<Self> {
        let mut child = Command::new(std::env::current_exe()?)
            .arg("guard")
            // A group of its own: Ctrl-C is not for it.
            .process_group(0)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()?;
        let line = in_one_line(config)?;
        if let Some(pipe) = &mut child.stdin {
            writeln!(pipe, "{line}")?;
        }
        Ok(Self { child, held: None })
    }

    /// Says where control is held, if it is. A guard that is gone is no reason
    /// to stop.
    pub(super) fn tell(&mut self, held: Option<PlantId>) {
        if self.held == held {
            return;
        }
        self.held = held;
        if let Some(pipe) = &mut self.child.stdin {
            let _ = match held {
                Some(plant) => writeln!(pipe, "{HELD}{plant}"),
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

/// A configuration file as one line: a string of JSON.
fn in_one_line(config: &Config) -> io::Result<String> {
    let text = toml::to_string(config).map_err(io::Error::other)?;
    Ok(serde_json::to_string(&text)?)
}

/// What a guard had to give back.
#[derive(Debug)]
pub(crate) struct GivenBack {
    /// The plant.
    pub(crate) plant: PlantId,
    /// How that ended.
    pub(crate) released: Released,
    /// What a person does there if it did not succeed.
    pub(crate) by_hand: &'static str,
}

/// Stands guard: reads `from` until it ends, and then gives back what is held;
/// none if nothing is.
///
/// # Errors
/// When what is read makes no sense, or nothing can be sent.
pub(crate) fn run_release_helper(
    from: impl BufRead,
) -> Result<Option<GivenBack>, ReleaseHelperError> {
    let mut lines = from.lines();
    let first = lines.next().ok_or(ReleaseHelperError::Nothing)??;
    let text: String = serde_json::from_str(&first)?;
    let config = Config::parse(&text, "standard input")?;
    let mut held: Option<PlantId> = None;
    // A pipe that breaks is a pipe that ends.
    for line in lines.map_while(Result::ok) {
        if line == FREE {
            held = None;
        } else if let Some(plant) = line.strip_prefix(HELD) {
            held = PlantId::new(format_args!("{plant}")).or(held);
        }
    }
    let Some((plant, authority)) = held.zip(authority_without_connection(&config)) else {
        return Ok(None);
    };
    let mut post = Post::at(&plant);
    let released = authority.release(&plant, PATIENCE, &mut || post.is_relieved())?;
    Ok(Some(GivenBack {
        plant,
        released,
        by_hand: authority.by_hand(),
    }))
}

/// Why a guard could not do its work.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub(crate) enum ReleaseHelperError {
    /// Nothing came through the pipe.
    #[error("fccd guard is started by fccd itself, which tells it what to guard")]
    Nothing,
    /// The pipe broke before it said anything.
    #[error("standard input: {0}")]
    Input(#[from] io::Error),
    /// The first line is not a string.
    #[error("the first line is no configuration as a string of JSON: {0}")]
    Line(#[from] serde_json::Error),
    /// The string is not a configuration.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Nothing can be sent to the plant.
    #[error("the controls cannot be given back: {0}")]
    Release(#[from] ActuatorFault),
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;
    use std::time::Duration;

    use fcc_flight::config::XPlaneSection;

    use super::*;

    fn script(simulator: &UdpSocket, last: &str) -> String {
        let config = Config {
            x_plane: Some(XPlaneSection::default()),
            ..Config::default()
        };
        let config = in_one_line(&config).unwrap();
        let at = simulator.local_addr().unwrap();
        format!("{config}\nheld X-Plane at {at}\n{last}")
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
            let released = guard.join().unwrap().unwrap().released;
            assert_eq!(released, Released::Confirmed);
        }
    }

    #[test]
    fn what_is_free_is_left_alone() {
        let simulator = simulator();
        let told = run_release_helper(script(&simulator, "free\n").as_bytes()).unwrap();
        assert!(told.is_none());
        assert!(simulator.recv(&mut [0; 600]).is_err(), "something was sent");
    }

    #[test]
    fn a_simulator_that_is_gone_holds_nothing() {
        let simulator = simulator();
        let script = script(&simulator, "");
        drop(simulator);
        let released = run_release_helper(script.as_bytes())
            .unwrap()
            .unwrap()
            .released;
        assert_eq!(released, Released::Unreachable);
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        let error = run_release_helper("what?\n".as_bytes()).unwrap_err();
        assert!(error.to_string().contains("no configuration"), "{error}");
        assert!(matches!(
            run_release_helper(&b""[..]),
            Err(ReleaseHelperError::Nothing)
        ));
    }
}
