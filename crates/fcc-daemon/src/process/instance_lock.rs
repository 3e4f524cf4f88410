//! One daemon for one plant.
//!
//! Two that see the same engage switch would both take the controls and write
//! over each other. The first holds a name that the kernel gives to one socket
//! only (abstract, see unix(7)) and takes back when the process ends, however
//! it does: no file is left behind by a daemon that was killed.
//!
//! The name is the plant's own, and not how a configuration finds it: who follows a beacon claims once the beacon has told the address,
//! and takes no control before.

use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId};

/// The right to control a plant; given up when dropped.
pub(super) struct InstanceLock {
    authority: Arc<dyn ControlAuthority>,
    claim: Claim,
}

enum Claim {
    /// Nobody has told where there is a plant.
    Nowhere,
    /// Where the kernel has no such names, nobody is kept from flying.
    Had {
        plant: PlantId,
        _name: Option<UnixDatagram>,
    },
    /// Another daemon controls it.
    Taken(PlantId),
}

impl InstanceLock {
    /// Claims what the connection leads to, if that is known yet. From here on
    /// control is taken only of what was claimed.
    pub(super) fn of(authority: Arc<dyn ControlAuthority>) -> Self {
        authority.require_permission();
        let mut this = Self {
            authority,
            claim: Claim::Nowhere,
        };
        this.follow();
        this
    }

    /// Claims the plant that was found since. It stays the same while its
    /// controls are held, so none is given up that is still controlled.
    pub(super) fn follow(&mut self) {
        let Some(plant) = self.authority.plant() else {
            return;
        };
        if matches!(self.claim, Claim::Had { plant: of, .. } | Claim::Taken(of) if of == plant) {
            return;
        }
        self.claim = match claim(&self.authority.unique(&plant)) {
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => Claim::Taken(plant),
            claimed => {
                self.authority.permit(&plant);
                Claim::Had {
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
            Claim::Nowhere | Claim::Had { .. } => None,
        }
    }
}

/// `AddrInUse` if another daemon of this machine has it.
fn claim(plant: &PlantId) -> io::Result<UnixDatagram> {
    UnixDatagram::bind_addr(&SocketAddr::from_abstract_name(format!("fccd/{plant}"))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_is_claimed_once_and_given_up() {
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
