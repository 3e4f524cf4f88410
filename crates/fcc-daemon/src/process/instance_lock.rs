//! Prevents two daemons from controlling one plant.
//!
//! Two daemons that read the same engage switch would both take control and
//! overwrite each other's outputs. The first binds a socket name (abstract, see
//! unix(7)) that the kernel gives to one socket only and frees when the process
//! ends for any reason: a killed daemon leaves no file.
//!
//! The name is that of the plant, not of its configuration: a daemon that
//! follows a beacon locks after it has received the address, and takes no
//! control before.

use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId};

/// The right to control a plant; released when dropped.
pub(super) struct InstanceLock {
    authority: Arc<dyn ControlAuthority>,
    claim: Claim,
}

enum Claim {
    /// No plant is known yet.
    NoPlant,
    /// If the kernel has no such names, two daemons are not prevented.
    Locked {
        plant: PlantId,
        _name: Option<UnixDatagram>,
    },
    /// Another daemon controls it.
    Taken(PlantId),
}

impl InstanceLock {
    /// Locks the connected plant, if it is known yet. Control is taken only of
    /// a locked plant.
    pub(super) fn of(authority: Arc<dyn ControlAuthority>) -> Self {
        authority.require_permission();
        let mut this = Self {
            authority,
            claim: Claim::NoPlant,
        };
        this.follow();
        this
    }

    /// Locks the plant that was found since. It does not change while its
    /// controls are held, so that no plant under control is unlocked.
    pub(super) fn follow(&mut self) {
        let Some(plant) = self.authority.plant() else {
            return;
        };
        if matches!(self.claim, Claim::Locked { plant: of, .. } | Claim::Taken(of) if of == plant) {
            return;
        }
        self.claim = match claim(&self.authority.unique(&plant)) {
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => Claim::Taken(plant),
            claimed => {
                self.authority.permit(&plant);
                Claim::Locked {
                    plant,
                    _name: claimed.ok(),
                }
            }
        };
    }

    /// The plant, if another daemon controls it.
    pub(super) const fn taken(&self) -> Option<PlantId> {
        match self.claim {
            Claim::Taken(plant) => Some(plant),
            Claim::NoPlant | Claim::Locked { .. } => None,
        }
    }
}

/// `AddrInUse` if another daemon of this machine has locked it.
fn claim(plant: &PlantId) -> io::Result<UnixDatagram> {
    UnixDatagram::bind_addr(&SocketAddr::from_abstract_name(format!("fccd/{plant}"))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_is_locked_once_and_unlocked() {
        let [one, other] = ["one", "another"]
            .map(|which| PlantId::new(format_args!("{which} of a test")).unwrap());
        let first = claim(&one).unwrap();
        let error = claim(&one).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AddrInUse);
        assert!(claim(&other).is_ok());
        drop(first);
        assert!(claim(&one).is_ok());
    }
}
