//! The simulator's address and the one at which control may be taken, each as
//! one atomic number.

use core::sync::atomic::{AtomicU64, Ordering};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};

/// Marks any address as allowed: no packed address has so many bits.
const ANYWHERE: u64 = u64::MAX;
/// Stands for the configured address: no packed address has these bits.
const CONFIGURED: u64 = u64::MAX - 1;
/// No address is allowed: no packed address is 0.
const NOWHERE: u64 = 0;

/// The address of the simulator.
#[derive(Debug)]
pub(crate) struct SharedAddress {
    /// The simulator's configured address, if there is one.
    configured: Option<SocketAddr>,
    /// [`CONFIGURED`], or the IPv4 address and port from a beacon in the low 48
    /// bits; 0 while unknown.
    simulator: AtomicU64,
    /// The address at which control may be taken, packed likewise, or
    /// [`ANYWHERE`].
    allowed: AtomicU64,
}

impl SharedAddress {
    /// With the configured address, if there is one; control may be taken
    /// anywhere.
    pub(crate) const fn new(configured: Option<SocketAddr>) -> Self {
        Self {
            configured,
            simulator: AtomicU64::new(match configured {
                Some(_) => CONFIGURED,
                None => NOWHERE,
            }),
            allowed: AtomicU64::new(ANYWHERE),
        }
    }

    /// The simulator's address, if it is known.
    pub(crate) fn simulator(&self) -> Option<SocketAddr> {
        match self.simulator.load(Ordering::Relaxed) {
            NOWHERE => None,
            CONFIGURED => self.configured,
            packed => Some(unpack(packed)),
        }
    }

    pub(crate) fn set_simulator(&self, address: SocketAddr) {
        self.simulator.store(self.pack(address), Ordering::Relaxed);
    }

    /// It is not known any more.
    pub(crate) fn forget(&self) {
        self.simulator.store(NOWHERE, Ordering::Relaxed);
    }

    /// An address as a number. Any address other than the configured one comes
    /// from a beacon, and beacons are sent over IPv4.
    fn pack(&self, address: SocketAddr) -> u64 {
        match address {
            configured if Some(configured) == self.configured => CONFIGURED,
            SocketAddr::V4(at) => (u64::from(at.ip().to_bits()) << 16) | u64::from(at.port()),
            SocketAddr::V6(_) => NOWHERE,
        }
    }

    /// Whether control may be taken there.
    pub(crate) fn is_allowed(&self, simulator: SocketAddr) -> bool {
        let allowed = self.allowed.load(Ordering::Acquire);
        allowed == ANYWHERE || (allowed != NOWHERE && allowed == self.pack(simulator))
    }

    pub(crate) fn allow(&self, simulator: Option<SocketAddr>) {
        let allowed = simulator.map_or(NOWHERE, |simulator| self.pack(simulator));
        self.allowed.store(allowed, Ordering::Release);
    }
}

fn unpack(packed: u64) -> SocketAddr {
    let [_, _, a, b, c, d, high, low] = packed.to_be_bytes();
    let port = u16::from_be_bytes([high, low]);
    SocketAddrV4::new(Ipv4Addr::new(a, b, c, d), port).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_restored_unchanged() {
        let [announced, v4, v6] = ["192.168.250.7:49000", "10.0.0.1:49000", "[fe80::1%2]:49000"]
            .map(|text| text.parse::<SocketAddr>().unwrap());
        for configured in [v4, v6] {
            let state = SharedAddress::new(Some(configured));
            assert_eq!(state.simulator(), Some(configured));
            state.allow(None);
            assert!(!state.is_allowed(configured) && !state.is_allowed(announced));
            state.allow(Some(configured));
            assert!(state.is_allowed(configured) && !state.is_allowed(announced));
        }
        let state = SharedAddress::new(None);
        assert_eq!(state.simulator(), None);
        state.set_simulator(announced);
        assert_eq!(state.simulator(), Some(announced));
        state.allow(Some(announced));
        assert!(state.is_allowed(announced) && !state.is_allowed(v4) && !state.is_allowed(v6));
    }
}
