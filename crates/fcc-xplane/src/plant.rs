//! The name of a simulator as a plant.

use std::net::SocketAddr;

use fcc_core::framework::PlantId;

/// Prefix of the name of an X-Plane plant; its address follows.
const NAME: &str = "X-Plane at ";

/// The X-Plane at an address, as [`XPlaneAuthority`](crate::XPlaneAuthority) names it.
pub fn plant_at(simulator: SocketAddr) -> Option<PlantId> {
    PlantId::new(format_args!("{NAME}{simulator}"))
}

pub(crate) fn address(plant: &PlantId) -> Option<SocketAddr> {
    plant.as_str().strip_prefix(NAME)?.parse().ok()
}
