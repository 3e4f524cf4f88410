//! Routes that are prepared beside the loop, to replace the one that is flown.

use core::fmt;

use super::{Route, RouteConfig};

/// Routes that are ready to be flown, by the hashes of their plans.
///
/// A route is made by another thread, in memory that outlives the loop, before the loop
/// is commanded to fly it. The tick that reads the command asks for it here.
pub trait PreparedRoutes: Sync + fmt::Debug {
    /// The route of the plan with this hash, as it is flown with a configuration; none if
    /// it is not there. Called in a tick: it does not wait, allocate or lock.
    fn route(&self, hash: u64, config: &RouteConfig) -> Option<Route<'static>>;
}

/// Where the routes are; by default nowhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct RouteSource(Option<&'static dyn PreparedRoutes>);

impl RouteSource {
    /// These routes.
    pub const fn new(routes: &'static dyn PreparedRoutes) -> Self {
        Self(Some(routes))
    }

    /// The route of a plan by its hash; none without a source.
    pub fn route(&self, hash: u64, config: &RouteConfig) -> Option<Route<'static>> {
        self.0.and_then(|routes| routes.route(hash, config))
    }
}

impl PartialEq for RouteSource {
    /// The same ones, in the same place.
    fn eq(&self, other: &Self) -> bool {
        match (self.0, other.0) {
            (Some(one), Some(other)) => core::ptr::addr_eq(one, other),
            (None, None) => true,
            _ => false,
        }
    }
}
