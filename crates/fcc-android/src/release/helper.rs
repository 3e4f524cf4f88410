//! The second process: it reads what the first one tells it, and releases what was held
//! when that one has ended.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use fcc_core::framework::{ControlAuthority, PlantId, Released};
use fcc_flight::config::Config;
use fcc_flight::flight::authority_without_connection;
use fcc_flight::release::{Told, from_one_line, release};

use super::mark::Mark;

/// The last takeover that this process has received, by any pipe: it ends a release on
/// behalf of an earlier one.
static LAST: AtomicU64 = AtomicU64::new(0);

/// What a flight has told so far.
#[derive(Default)]
pub(super) struct Session {
    authority: Option<Arc<dyn ControlAuthority>>,
    told: Told,
    /// Whether a later start releases what was left.
    pub(super) releases_left: bool,
}

impl Session {
    /// Takes a line: that of a configuration begins a flight.
    pub(super) fn line(&mut self, line: &str) {
        if line.starts_with('"') {
            let config = from_one_line(line).ok();
            self.authority = config.as_ref().and_then(authority_without_connection);
            let releases = |config: &Config| config.restart.release_left_held;
            self.releases_left = config.as_ref().is_some_and(releases);
            self.told = Told::default();
            return;
        }
        let before = self.told.held();
        self.told.line(line);
        if let Some((_, plant)) = self.told.held().filter(|held| before != Some(*held)) {
            LAST.fetch_add(1, Ordering::SeqCst);
            if let Some(authority) = &self.authority {
                authority.prepare_release(&plant);
            }
        }
    }

    /// What is to be released.
    pub(super) fn held(&self) -> Option<Left> {
        let (_, plant) = self.told.held()?;
        let authority = self.authority.clone()?;
        if let Some(from) = self.told.answers_from() {
            authority.expect(&plant, from);
        }
        let after = LAST.load(Ordering::SeqCst);
        Some(Left {
            authority,
            plant,
            after,
        })
    }
}

/// What a flight has left held.
pub(super) struct Left {
    authority: Arc<dyn ControlAuthority>,
    plant: PlantId,
    after: u64,
}

impl Left {
    /// Releases it, unless another takeover is told or `is_cancelled` says so; what
    /// became of it, for users, and whether it is over.
    pub(super) fn release(&self, is_cancelled: impl Fn() -> bool) -> (String, bool) {
        let (plant, authority) = (self.plant, self.authority.as_ref());
        let mut ends = || LAST.load(Ordering::SeqCst) != self.after || is_cancelled();
        match release(authority, &plant, &mut ends) {
            Ok(Released::Confirmed) => (format!("{plant} was released"), true),
            Ok(Released::Unreachable) => (format!("{plant} has ended"), true),
            Ok(Released::Cancelled) => (String::new(), false),
            Ok(Released::Refused | Released::Unconfirmed) => (
                format!(
                    "{plant} did not confirm the release of its controls: {}",
                    authority.by_hand()
                ),
                false,
            ),
            Err(error) => (format!("{plant} cannot be released: {error}"), false),
        }
    }
}

/// Serves the flights of a process until it ends, and then releases what it held; what
/// became of that, for users, empty if there was nothing. Their mark is in `folder`.
pub(crate) fn serve(pipe: impl Read, folder: &Path) -> String {
    let mut session = Session::default();
    // A broken pipe counts as its end.
    for line in BufReader::new(pipe).lines().map_while(Result::ok) {
        session.line(&line);
        if session.told.is_over() {
            let left = session.held();
            session.told = Told::default();
            if let Some(left) = left {
                // The next flight is told meanwhile. Without a thread nothing is lost that
                // the next start does not release.
                let _ = thread::Builder::new()
                    .name("fcc-release".to_owned())
                    .spawn(move || left.release(|| false));
            }
        }
    }
    let Some(left) = session.held() else {
        return String::new();
    };
    let (became, is_over) = left.release(|| false);
    if is_over {
        Mark::in_folder(folder).remove();
    }
    became
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;

    use fcc_flight::release::in_one_line;

    use super::super::{Mark, release_left};
    use super::*;

    /// A simulator that never answers, and what a flight tells that holds it.
    fn held() -> (UdpSocket, String, PlantId) {
        let simulator = UdpSocket::bind("127.0.0.1:0").unwrap();
        let at = simulator.local_addr().unwrap();
        let config = Config::parse("[x-plane]\n", "test").unwrap();
        let plant = PlantId::new(format_args!("X-Plane at {at}")).unwrap();
        (simulator, in_one_line(&config).unwrap(), plant)
    }

    fn told(lines: &str) -> Session {
        let mut session = Session::default();
        lines.lines().for_each(|line| session.line(line));
        session
    }

    #[test]
    fn a_release_ends_when_another_flight_takes_control() {
        let (_simulator, config, plant) = held();
        let lines = format!("{config}\nheld 1 {plant}\n");
        let first = told(&lines).held().unwrap();
        let releasing = thread::spawn(move || first.release(|| false));
        while !releasing.is_finished() {
            // As of an app that was started again.
            assert!(told(&lines).held().is_some());
            thread::yield_now();
        }
        assert_eq!(releasing.join().unwrap(), (String::new(), false));
    }

    #[test]
    fn nothing_is_released_that_is_free_or_of_no_configuration() {
        let (_simulator, config, plant) = held();
        for lines in [
            String::new(),
            config.clone(),
            format!("held 1 {plant}\n"),
            format!("{config}\nheld 1 {plant}\nfree 1\n"),
            // The next flight of the same process begins.
            format!("{config}\nheld 1 {plant}\n{config}\n"),
            format!("\"[x-plane\"\nheld 1 {plant}\n"),
        ] {
            assert!(told(&lines).held().is_none(), "{lines}");
            let folder = tempfile::tempdir().unwrap();
            assert_eq!(serve(lines.as_bytes(), folder.path()), "");
        }
    }

    #[test]
    fn a_mark_that_is_damaged_or_not_to_be_released_is_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let (simulator, _, plant) = held();
        let path = folder.path().join("held");
        std::fs::write(&path, "what?\n").unwrap();
        assert_eq!(release_left(folder.path()), "");
        assert!(!path.exists());
        let kept = "[x-plane]\n[restart]\nrelease_left_held = false\n";
        let kept = in_one_line(&Config::parse(kept, "test").unwrap()).unwrap();
        Mark::in_folder(folder.path()).set(&kept, &plant).unwrap();
        assert_eq!(release_left(folder.path()), "");
        assert!(path.exists());
        simulator.set_nonblocking(true).unwrap();
        assert!(simulator.recv(&mut [0; 600]).is_err(), "something was sent");
    }
}
