//! A second process that outlives this one, to release the controls if this one
//! is killed.
//!
//! A simulator never clears its overrides by itself, and a process that is
//! killed can do nothing more. So before a flight this program starts itself
//! again as `fccd release-helper`, which waits at the end of a pipe. Through
//! the pipe it [is told](super::notice) where control is held, before anything
//! is written there; the pipe closes when this process ends for any reason. If
//! control was held then, the helper releases it until the plant confirms it,
//! or until a daemon that takes control itself
//! [ends it](super::release_handover).

use std::io::{self, BufRead, Write};
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{ActuatorFault, PlantId, Released};
use fcc_flight::config::Config;
use fcc_flight::flight::authority_without_connection;
use fcc_flight::release::{NoConfigError, Told, from_one_line, in_one_line, release};
use fcc_telemetry::{RunFolder, not_started};

use super::notice::Notice;
use super::own_program::own_program;
use super::plant_file::PlantFile;
use super::release_handover::{HelperLock, RELEASE_HELPER};

/// How long the end of a helper that was killed is waited for.
const ENDS_WITHIN: Duration = Duration::from_millis(200);

/// The release helper, as seen by the process that started it.
pub(crate) struct ReleaseHelper {
    child: Child,
}

impl ReleaseHelper {
    /// Starts the helper, and tells it where control is held; from here on
    /// `notice` does.
    ///
    /// # Errors
    /// When this program cannot be started a second time.
    pub(super) fn start(
        config: &Config,
        notice: &Notice,
        held: Option<PlantId>,
    ) -> io::Result<Self> {
        let line = in_one_line(config)?;
        let child = own_program(RELEASE_HELPER)
            .stdin(Stdio::piped())
            .spawn()
            .map_err(not_started)?;
        let mut this = Self { child };
        match this.configure(&line, notice, held) {
            Ok(()) => Ok(this),
            Err(error) => {
                this.end();
                Err(error)
            }
        }
    }

    fn configure(&mut self, line: &str, notice: &Notice, held: Option<PlantId>) -> io::Result<()> {
        let mut pipe = self.child.stdin.take().ok_or(io::ErrorKind::BrokenPipe)?;
        // The new pipe has room for it.
        writeln!(pipe, "{line}")?;
        notice.add_helper(pipe, held)
    }

    /// Its process number.
    pub(super) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Whether it has ended by itself, or was killed; never waits.
    pub(super) fn has_ended(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(Some(_)))
    }

    /// Ends a helper that has nothing to release, also one that is stopped.
    pub(super) fn end(mut self) {
        let _ = self.child.kill();
        let until = Instant::now() + ENDS_WITHIN;
        while !self.has_ended() && Instant::now() < until {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

/// What a helper had to release.
#[derive(Debug)]
pub(crate) struct HelperResult {
    /// The plant.
    pub(crate) plant: PlantId,
    /// The result of the release.
    pub(crate) released: Released,
    /// What a user does at the plant if it did not succeed.
    pub(crate) by_hand: &'static str,
}

/// Runs the helper: reads `from` until it ends, and then releases what is held;
/// none if nothing is.
///
/// # Errors
/// When the input is invalid, or nothing can be sent.
pub(crate) fn run_release_helper(
    from: impl BufRead,
) -> Result<Option<HelperResult>, ReleaseHelperError> {
    let mut lines = from.lines();
    let first = lines.next().ok_or(ReleaseHelperError::Nothing)??;
    let config = from_one_line(&first)?;
    let mut folder = None;
    let authority = authority_without_connection(&config);
    let mut told = Told::default();
    let mut lock: Option<HelperLock> = None;
    // A broken pipe counts as its end.
    for line in lines.map_while(Result::ok) {
        told.line(&line);
        if told.is_over() {
            break;
        }
        let held = told.held().zip(authority.as_ref());
        if let Some(((_, plant), authority)) = held {
            authority.prepare_release(&plant);
        }
        let unique = held.map(|((_, plant), authority)| authority.unique(&plant));
        let is_locked = match (&lock, unique) {
            (Some(lock), Some(plant)) => lock.is_of(plant),
            (lock, _) => lock.is_none() && unique.is_none(),
        };
        if !is_locked {
            // One of another plant is unlocked first.
            drop(lock.take());
            // It may have been removed.
            folder = RunFolder::of_this_process(&mut drop);
            lock = folder
                .as_ref()
                .zip(unique)
                .and_then(|(folder, plant)| HelperLock::of(folder, plant));
        }
    }
    let Some(((number, plant), authority)) = told.held().zip(authority) else {
        return Ok(None);
    };
    if let Some(lock) = &lock {
        lock.lock();
    }
    if let Some(from) = told.answers_from() {
        authority.expect(&plant, from);
    }
    let released = release(authority.as_ref(), &plant, &mut || false)?;
    // The next start need not release it.
    if released == Released::Confirmed
        && let Some(folder) = folder
        && let Ok(file) = PlantFile::open(&folder, &authority.unique(&plant))
    {
        file.release(number);
        file.remove_if_released();
    }
    Ok(Some(HelperResult {
        plant,
        released,
        by_hand: authority.by_hand(),
    }))
}

/// Why a helper could not do its work.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub(crate) enum ReleaseHelperError {
    /// Nothing came through the pipe.
    #[error("fccd release-helper is started by fccd itself, with its input")]
    Nothing,
    /// The pipe broke before the first line.
    #[error("standard input: {0}")]
    Input(#[from] io::Error),
    /// The first line is not a configuration.
    #[error(transparent)]
    Config(#[from] NoConfigError),
    /// Nothing can be sent to the plant.
    #[error("the controls cannot be released: {0}")]
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
        format!("{config}\nheld 1 X-Plane at {at}\n{last}")
    }

    fn simulator() -> UdpSocket {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket
            .set_read_timeout(Some(Duration::from_secs(1)))
            .unwrap();
        socket
    }

    /// Answers with X-Plane's layouts: DREF is five bytes, an f32, the path;
    /// RREF five bytes, frequency, index, the path; its reply five bytes, then
    /// pairs of index and f32.
    fn answer(simulator: &UdpSocket, ignored: u32) -> f32 {
        let mut joystick = 1.0_f32;
        let mut bytes = [0; 600];
        let mut written = 0;
        while let Ok((length, from)) = simulator.recv_from(&mut bytes) {
            let text = String::from_utf8_lossy(&bytes[..length]).into_owned();
            if text.starts_with("DREF") && text.contains("override_joystick") {
                written += 1;
                if written > ignored {
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
    fn when_the_pipe_ends_the_controls_are_released_until_confirmed() {
        for ignored in [0, 3] {
            let simulator = simulator();
            let script = script(&simulator, "");
            let helper = thread::spawn(move || run_release_helper(script.as_bytes()).unwrap());
            assert!(answer(&simulator, ignored).abs() < 0.5);
            let released = helper.join().unwrap().unwrap().released;
            assert_eq!(released, Released::Confirmed);
        }
    }

    #[test]
    fn controls_that_are_not_held_are_not_released() {
        let simulator = simulator();
        let result = run_release_helper(script(&simulator, "free 1\n").as_bytes()).unwrap();
        assert!(result.is_none());
        assert!(simulator.recv(&mut [0; 600]).is_err(), "something was sent");
    }

    #[test]
    fn invalid_input_is_refused_with_a_message() {
        let error = run_release_helper("what?\n".as_bytes()).unwrap_err();
        assert!(error.to_string().contains("not a configuration"), "{error}");
        assert!(matches!(
            run_release_helper(&b""[..]),
            Err(ReleaseHelperError::Nothing)
        ));
    }
}
