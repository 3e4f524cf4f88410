//! A plan as a whole.

use std::fmt::{self, Write as _};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::command;
use crate::item::{Item, Place};

/// The largest sizes of a plan. A file with more is refused.
pub mod limits {
    /// Items.
    pub const ITEMS: usize = 1_000;
    /// Polygons and circles of a fence, each.
    pub const FENCES: usize = 32;
    /// Corners of all polygons of a fence.
    pub const FENCE_CORNERS: usize = 1_000;
    /// Rally points.
    pub const RALLY_POINTS: usize = 100;
    /// Obstacles.
    pub const OBSTACLES: usize = 1_000;
    /// Bytes of a file.
    pub const FILE_BYTES: u64 = 4 << 20;
    /// Problems that are listed.
    pub const PROBLEMS: usize = 200;
}

/// Where the aircraft takes off and returns to.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Home {
    /// Where.
    pub place: Place,
    /// Above mean sea level, m.
    pub altitude_m: f64,
}

/// A polygon of a fence.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Its corners, at least 3, in order; the last is joined to the first. It is
    /// the side that has less than half of the earth.
    pub corners: Vec<Place>,
    /// Stay inside; otherwise outside.
    pub inclusion: bool,
    /// The group of an inclusion.
    #[serde(default)]
    pub group: u16,
}

/// A circle of a fence.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// The centre.
    pub centre: Place,
    /// In m, positive.
    pub radius_m: f64,
    /// Stay inside; otherwise outside.
    pub inclusion: bool,
    /// The group of an inclusion.
    #[serde(default)]
    pub group: u16,
}

/// Where the aircraft may fly: inside all inclusions of at least one group, if there is any,
/// and outside all others.
#[derive(Clone, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Fence {
    /// Polygons.
    pub polygons: Vec<Polygon>,
    /// Circles.
    pub circles: Vec<Circle>,
    /// The lowest altitude above mean sea level, m.
    pub floor_m: Option<f64>,
    /// The highest altitude above mean sea level, m.
    pub ceiling_m: Option<f64>,
    /// Where to fly after the fence was crossed, with an altitude above home, m; 0: the
    /// usual one of a return.
    pub return_point: Option<(Place, f64)>,
}

impl Fence {
    /// Whether it limits nothing.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// A place to fly to instead of home.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RallyPoint {
    /// Where.
    pub place: Place,
    /// Above home, m.
    pub altitude_m: f64,
}

/// A mast or a building: a cylinder.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// The centre.
    pub centre: Place,
    /// In m, positive.
    pub radius_m: f64,
    /// Of its top above mean sea level, m.
    pub top_m: f64,
}

/// A flight plan.
#[derive(Clone, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    /// Where the aircraft takes off and returns to.
    pub home: Option<Home>,
    /// Calibrated airspeed of the first leg, m/s; none: the aircraft's usual one.
    pub cruise_mps: Option<f64>,
    /// What is flown, in order.
    pub items: Vec<Item>,
    /// Where the aircraft may fly.
    pub fence: Fence,
    /// Places to return to, if nearer than home.
    pub rally: Vec<RallyPoint>,
    /// What it must not fly into.
    pub obstacles: Vec<Obstacle>,
}

impl Plan {
    /// The item with this number, from 1.
    pub fn item(&self, number: usize) -> Option<&Item> {
        number.checked_sub(1).and_then(|n| self.items.get(n))
    }

    /// The hash of the content, whatever file it was in.
    pub fn hash(&self) -> PlanHash {
        let mut hash = Sha256::new();
        hash.update(command::canonical(self));
        PlanHash(hash.finalize().into())
    }
}

/// SHA-256 of a plan's content.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub struct PlanHash(pub [u8; 32]);

impl PlanHash {
    /// Its first 64 bits, which are in the record of every tick.
    pub fn first_64_bits(&self) -> u64 {
        let first = self.0.iter().take(8);
        first.fold(0, |bits, byte| bits << 8 | u64::from(*byte))
    }
}

impl fmt::Display for PlanHash {
    /// In hexadecimal; with a precision, so many digits of it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.0.iter().fold(String::new(), |mut digits, byte| {
            let _ = write!(digits, "{byte:02x}");
            digits
        });
        f.pad(&digits)
    }
}

impl Serialize for PlanHash {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Which plan it is, wherever one is shown: two uploads of one plan differ in their
/// times only.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct Identity {
    /// Of the content.
    pub hash: PlanHash,
    /// When it was uploaded, in s since 1970 (UTC).
    pub uploaded_s: u64,
}

impl Identity {
    /// Of a plan that is uploaded at this time, in s since 1970 (UTC).
    pub fn of(plan: &Plan, uploaded_s: u64) -> Self {
        Self {
            hash: plan.hash(),
            uploaded_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_shown_in_as_many_digits_as_wanted() {
        let hash = PlanHash([0xab; 32]);
        assert_eq!(hash.first_64_bits(), 0xabab_abab_abab_abab);
        assert_eq!(format!("{hash:.12}"), "abababababab");
        assert_eq!(hash.to_string().len(), 64);
    }
}
