//! What may block engaging or fail the flight, as bits of [`Flags`].

use crate::flight::navigation::Frozen;
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

/// Pitch or roll stand still while the gyroscopes turn.
pub const FROZEN_ATTITUDE: Flags = Flags::bit(13);
/// The heading stands still while the gyroscopes turn.
pub const FROZEN_HEADING: Flags = Flags::bit(14);
/// The gyroscopes stand still while attitude or heading turn.
pub const FROZEN_BODY_RATES: Flags = Flags::bit(15);
/// The accelerometers stand still while the aircraft banks or pitches.
pub const FROZEN_SPECIFIC_FORCE: Flags = Flags::bit(16);
/// The airspeed stands still while the aircraft banks or pitches.
pub const FROZEN_AIRSPEED: Flags = Flags::bit(17);
/// The altitude stands still while the aircraft climbs or descends.
pub const FROZEN_ALTITUDE: Flags = Flags::bit(18);
/// One of the readings that are too old comes, but cannot be true: out of
/// range, or too far from the last.
pub const REJECTED: Flags = Flags::bit(19);

/// From the bit of a quantity that is too old to that of one that is frozen.
const FROZEN_SHIFT: u32 = 13;

/// A set with the quantities that are frozen among those that are too old:
/// neither is there to fly by.
pub(super) const fn gone(stale: Flags, frozen: Flags) -> Flags {
    Flags::from_bits(stale.bits() | frozen.bits() >> FROZEN_SHIFT)
}

/// The bits of what is frozen.
pub(super) const fn frozen(frozen: Frozen) -> Flags {
    Flags::NONE
        .with(FROZEN_ATTITUDE, frozen.attitude)
        .with(FROZEN_HEADING, frozen.heading)
        .with(FROZEN_BODY_RATES, frozen.body_rates)
        .with(FROZEN_SPECIFIC_FORCE, frozen.specific_force)
        .with(FROZEN_AIRSPEED, frozen.airspeed)
        .with(FROZEN_ALTITUDE, frozen.altitude)
}

/// What each bit says, lowest first.
pub(super) const NAMES: [&str; 20] = [
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
    "attitude is frozen",
    "heading is frozen",
    "body rates are frozen",
    "acceleration is frozen",
    "airspeed is frozen",
    "altitude is frozen",
    "what is measured cannot be true",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_frozen_is_gone_under_its_own_name() {
        let pairs = [
            (ATTITUDE, FROZEN_ATTITUDE),
            (HEADING, FROZEN_HEADING),
            (BODY_RATES, FROZEN_BODY_RATES),
            (SPECIFIC_FORCE, FROZEN_SPECIFIC_FORCE),
            (AIRSPEED, FROZEN_AIRSPEED),
            (ALTITUDE, FROZEN_ALTITUDE),
        ];
        for (stale, frozen) in pairs {
            assert_eq!(gone(Flags::NONE, frozen), stale);
        }
    }
}
