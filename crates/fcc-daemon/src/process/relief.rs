//! How a daemon that takes control relieves the guard of one that was killed.
//!
//! A guard goes on releasing the overrides until X-Plane shows them released,
//! for two minutes if need be. A daemon that was started again and flies would
//! have its controls pulled away by it. So the guard listens, while it
//! releases, at a socket that is named after the plant; whoever is about to
//! take control there connects, and the guard goes.
//!
//! The name is an abstract one: no file stays behind, and it reaches as far as
//! one network namespace. Anybody in
//! there can connect; a guard goes for who runs as the same user, and for root.

use std::io::{ErrorKind, Read};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener, UnixStream};
use std::time::Duration;

use fcc_core::framework::PlantId;
use nix::sys::socket::{getsockopt, sockopt::PeerCredentials};
use nix::unistd::{Uid, geteuid};

use crate::output;

/// How long a guard may take to go: it looks every 20 ms.
const GOES_WITHIN: Duration = Duration::from_secs(1);

fn name(plant: &PlantId) -> std::io::Result<SocketAddr> {
    SocketAddr::from_abstract_name(format!("fccd-guard-{plant}"))
}

/// Where a guard is found while it releases.
pub(super) struct Post {
    listener: Option<UnixListener>,
    /// Closed with the guard, which tells the other end that it is gone.
    relief: Option<UnixStream>,
}

impl Post {
    /// Opens the post. Where that fails, nobody can relieve this guard, and it
    /// releases to the end.
    pub(super) fn at(plant: &PlantId) -> Self {
        let listener = name(plant)
            .and_then(|name| UnixListener::bind_addr(&name))
            .and_then(|listener| listener.set_nonblocking(true).map(|()| listener));
        Self {
            listener: listener.ok(),
            relief: None,
        }
    }

    /// Whether somebody has come; never waits.
    pub(super) fn is_relieved(&mut self) -> bool {
        if let Some(Ok((stream, _))) = self.listener.as_ref().map(UnixListener::accept)
            && user(&stream).is_some_and(|user| may_relieve(user, geteuid()))
        {
            self.relief = Some(stream);
        }
        self.relief.is_some()
    }
}

/// Who is at the other end, as the kernel says.
fn user(stream: &UnixStream) -> Option<Uid> {
    let credentials = getsockopt(stream, PeerCredentials).ok()?;
    Some(Uid::from_raw(credentials.uid()))
}

/// Whether `user` may send away a guard that runs as `guard`.
fn may_relieve(user: Uid, guard: Uid) -> bool {
    user == guard || user.is_root()
}

/// Relieves the guard that releases `plant`, if there is one, and waits for
/// a moment until it is gone. Whether there was one.
pub(super) fn relieve(plant: &PlantId) -> bool {
    let Ok(mut stream) = name(plant).and_then(|name| UnixStream::connect_addr(&name)) else {
        return false;
    };
    let gone = stream
        .set_read_timeout(Some(GOES_WITHIN))
        .and_then(|()| stream.read(&mut [0; 1]));
    if let Err(error) = gone
        && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
    {
        output::message(
            "the guard of the daemon before this one does not go: it may give the controls away",
        );
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No other test has this one.
    fn plant() -> PlantId {
        PlantId::new(format_args!("the plant of a test")).unwrap()
    }

    #[test]
    fn a_guard_goes_for_its_own_user_and_root_alone() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        assert_eq!(user(&ours), Some(geteuid()));
        drop(theirs);
        let [guard, stranger] = [1_000, 1_001].map(Uid::from_raw);
        assert!(may_relieve(guard, guard));
        assert!(may_relieve(Uid::from_raw(0), guard));
        assert!(!may_relieve(stranger, guard));
        assert!(!may_relieve(stranger, Uid::from_raw(0)));
    }

    #[test]
    fn a_guard_is_relieved_once_somebody_comes_and_not_before() {
        assert!(!relieve(&plant()), "there is none");
        let mut post = Post::at(&plant());
        assert!(!post.is_relieved());
        let comes = std::thread::spawn(|| relieve(&plant()));
        while !post.is_relieved() {
            std::thread::yield_now();
        }
        drop(post);
        assert!(comes.join().unwrap());
        assert!(!relieve(&plant()), "it is gone");
    }
}
