//! How a daemon that takes control ends the release helper of one that was
//! killed.
//!
//! A release helper repeats the release until the plant confirms it, for up to
//! two minutes. It would thereby take control from a daemon that was started
//! again and flies. So while it releases, the helper listens at a socket named
//! after the plant; a program that is about to take control connects to it, and
//! the helper ends.
//!
//! The name is an abstract one: no file is left behind, and it is valid within
//! one network namespace. Any process there can connect; a helper ends only for
//! the same user and for root.

use std::io::{ErrorKind, Read};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener, UnixStream};
use std::time::Duration;

use fcc_core::framework::PlantId;
use nix::sys::socket::{getsockopt, sockopt::PeerCredentials};
use nix::unistd::{Uid, geteuid};

use crate::output;

/// How long a helper may take to end: it checks every 20 ms.
const ENDS_WITHIN: Duration = Duration::from_secs(1);

fn name(plant: &PlantId) -> std::io::Result<SocketAddr> {
    SocketAddr::from_abstract_name(format!("fccd-release-helper-{plant}"))
}

/// The socket of a helper while it releases.
pub(super) struct HandoverPoint {
    listener: Option<UnixListener>,
    /// Closed when the helper ends, which the other side detects.
    successor: Option<UnixStream>,
}

impl HandoverPoint {
    /// Opens the socket. If that fails, this helper cannot be ended, and
    /// releases to its end.
    pub(super) fn at(plant: &PlantId) -> Self {
        let listener = name(plant)
            .and_then(|name| UnixListener::bind_addr(&name))
            .and_then(|listener| listener.set_nonblocking(true).map(|()| listener));
        Self {
            listener: listener.ok(),
            successor: None,
        }
    }

    /// Whether a program has connected; never waits.
    pub(super) fn is_requested(&mut self) -> bool {
        if let Some(Ok((stream, _))) = self.listener.as_ref().map(UnixListener::accept)
            && user(&stream).is_some_and(|user| may_end(user, geteuid()))
        {
            self.successor = Some(stream);
        }
        self.successor.is_some()
    }
}

/// The user at the other end, from the kernel.
fn user(stream: &UnixStream) -> Option<Uid> {
    let credentials = getsockopt(stream, PeerCredentials).ok()?;
    Some(Uid::from_raw(credentials.uid()))
}

/// Whether `user` may end a helper that runs as `helper`.
fn may_end(user: Uid, helper: Uid) -> bool {
    user == helper || user.is_root()
}

/// Ends the helper that releases `plant`, if there is one, and waits up to a
/// second until it has ended. Returns whether there was one.
pub(super) fn end_helper(plant: &PlantId) -> bool {
    let Ok(mut stream) = name(plant).and_then(|name| UnixStream::connect_addr(&name)) else {
        return false;
    };
    let ended = stream
        .set_read_timeout(Some(ENDS_WITHIN))
        .and_then(|()| stream.read(&mut [0; 1]));
    if let Err(error) = ended
        && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
    {
        output::message(
            "the release helper of the previous daemon does not end: it may release the controls",
        );
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Used by no other test.
    fn plant() -> PlantId {
        PlantId::new(format_args!("the plant of a test")).unwrap()
    }

    #[test]
    fn a_helper_ends_only_for_its_own_user_and_root() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        assert_eq!(user(&ours), Some(geteuid()));
        drop(theirs);
        let [helper, stranger] = [1_000, 1_001].map(Uid::from_raw);
        assert!(may_end(helper, helper));
        assert!(may_end(Uid::from_raw(0), helper));
        assert!(!may_end(stranger, helper));
        assert!(!may_end(stranger, Uid::from_raw(0)));
    }

    #[test]
    fn a_helper_ends_once_a_program_connects_and_not_before() {
        assert!(!end_helper(&plant()), "there is no helper");
        let mut handover = HandoverPoint::at(&plant());
        assert!(!handover.is_requested());
        let connects = std::thread::spawn(|| end_helper(&plant()));
        while !handover.is_requested() {
            std::thread::yield_now();
        }
        drop(handover);
        assert!(connects.join().unwrap());
        assert!(!end_helper(&plant()), "it has ended");
    }
}
