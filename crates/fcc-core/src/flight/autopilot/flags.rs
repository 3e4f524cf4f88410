//! What may block engaging or fail the flight, as bits of [`Flags`].

use crate::framework::Flags;

/// Pitch and roll are too old.
pub const ATTITUDE: Flags = Flags::bit(0);
/// The heading is too old.
pub const HEADING: Flags = Flags::bit(1);
/// The body rates are too old.
pub const BODY_RATES: Flags = Flags::bit(2);
/// The specific force is too old.
pub const SPECIFIC_FORCE: Flags = Flags::bit(3);
/// The airspeed is too old.
pub const AIRSPEED: Flags = Flags::bit(4);
/// The altitude is too old.
pub const ALTITUDE: Flags = Flags::bit(5);
/// The simulator's clock jumped.
pub const PLANT_JUMPED: Flags = Flags::bit(6);
/// The simulator is paused.
pub const PLANT_PAUSED: Flags = Flags::bit(7);
/// Too slow to be flying.
pub const TOO_SLOW: Flags = Flags::bit(8);
/// Bank or pitch is beyond what may be taken over.
pub const UPSET: Flags = Flags::bit(9);
/// The simulator's clock stands still and it does not say paused.
pub const PLANT_STALLED: Flags = Flags::bit(10);
/// The engage switch was there and is silent.
pub const ENGAGE_SWITCH: Flags = Flags::bit(11);
/// Navigation has not watched for long enough.
pub const SETTLING: Flags = Flags::bit(12);

/// What each bit says, lowest first.
pub(super) const NAMES: [&str; 13] = [
    "attitude is missing or too old",
    "heading is missing or too old",
    "body rates are missing or too old",
    "acceleration is missing or too old",
    "airspeed is missing or too old",
    "altitude is missing or too old",
    "simulator time jumped",
    "simulator is paused",
    "airspeed is below the floor",
    "bank or pitch is beyond 60 degrees",
    "simulator time stands still",
    "engage switch is silent",
    "navigation is settling",
];
