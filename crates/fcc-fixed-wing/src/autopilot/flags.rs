//! Engage inhibits and faults, as bits of [`Flags`].

use fcc_core::framework::Flags;
use fcc_navigation::{Quantities, Quantity};

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
/// The airspeed is too low for flight; or it rolls, or stands where no take-off begins.
pub const TOO_SLOW: Flags = Flags::bit(8);
/// Bank or pitch is too large for engaging.
pub const UPSET: Flags = Flags::bit(9);
/// The simulator's clock has stopped, but the aircraft moves.
pub const PLANT_STALLED: Flags = Flags::bit(10);
/// The engage switch was read before and is now silent.
pub const ENGAGE_SWITCH: Flags = Flags::bit(11);
/// Navigation has not settled yet.
pub const SETTLING: Flags = Flags::bit(12);

/// Pitch or roll do not change although the gyroscopes show a rotation.
pub const FROZEN_ATTITUDE: Flags = Flags::bit(13);
/// The heading does not change although the gyroscopes show a rotation.
pub const FROZEN_HEADING: Flags = Flags::bit(14);
/// The gyroscopes do not change although attitude or heading do.
pub const FROZEN_BODY_RATES: Flags = Flags::bit(15);
/// The accelerometers do not change although the aircraft banks or pitches.
pub const FROZEN_SPECIFIC_FORCE: Flags = Flags::bit(16);
/// The airspeed does not change although the aircraft banks or pitches.
pub const FROZEN_AIRSPEED: Flags = Flags::bit(17);
/// One of the readings that are too old does arrive, but is implausible: out of
/// range, or too far from the last.
pub const REJECTED: Flags = Flags::bit(19);

/// Nothing arrives from the simulator.
pub const PLANT_SILENT: Flags = Flags::bit(20);
/// The simulator took back the controls by itself: it was reloaded.
pub const PLANT_RELOADED: Flags = Flags::bit(21);
/// The simulator shows a recorded flight.
pub const PLANT_REPLAYING: Flags = Flags::bit(23);

/// Another autopilot's servos move the controls.
pub const OTHER_AUTOPILOT: Flags = Flags::bit(24);
/// The simulator's time runs more than twice as fast as ours.
pub const PLANT_FAST: Flags = Flags::bit(30);
/// The airspeed contradicts the other sensors and is not used.
pub const DOUBTED_AIRSPEED: Flags = Flags::bit(32);
/// The aircraft is recovered from an upset.
pub const RECOVERING: Flags = Flags::bit(33);
/// The loops or the airframe oscillate: gain is taken out.
pub const OSCILLATION: Flags = Flags::bit(34);
/// The outputs take effect too late for the configured gains.
pub const LATE_EFFECT: Flags = Flags::bit(35);
/// The outputs do not reach the aircraft.
pub const NOT_FOLLOWED: Flags = Flags::bit(36);
/// There is not enough energy for speed and height: height is given up.
pub const UNDERSPEED: Flags = Flags::bit(37);
/// A reading is from the future.
pub const FROM_THE_FUTURE: Flags = Flags::bit(38);
/// A quantity is lost, and the flight goes on without it.
pub const DEGRADED: Flags = Flags::bit(39);
/// The target altitude is limited by the floor, or by the fence.
pub const AT_FLOOR: Flags = Flags::bit(40);
/// The pilot moves the controls.
pub const PILOT_TAKES_OVER: Flags = Flags::bit(41);
/// Readings arrive too old, by their source's own clock.
pub const SOURCE_CLOCK: Flags = Flags::bit(42);
/// The altitude contradicts the other sensors and is not used.
pub const DOUBTED_ALTITUDE: Flags = Flags::bit(43);
/// A release is being prepared: the aircraft is levelled and trimmed.
pub const RELEASING: Flags = Flags::bit(44);
/// The measured elevator trim does not move as commanded.
pub const TRIM_NOT_FOLLOWED: Flags = Flags::bit(45);
/// A release is being prepared, and the trim does not follow.
pub const UNTRIMMED: Flags = Flags::bit(46);
/// The wing has stalled above the configured stalling speed.
pub const STALLS_FASTER: Flags = Flags::bit(48);
/// The body rates are not the derivatives of pitch, roll and heading.
pub const ATTITUDE_AGAINST_RATES: Flags = Flags::bit(49);
/// The vertical acceleration is not that of flight.
pub const LOAD_AGAINST_GRAVITY: Flags = Flags::bit(50);
/// Forward acceleration and airspeed contradict the pitch.
pub const PITCH_AGAINST_FORCE: Flags = Flags::bit(51);

/// The attitude contradicts the body rates and the other sensors, and is not used.
pub const DOUBTED_ATTITUDE: Flags = Flags::bit(52);
/// The body rates contradict the attitude and the other sensors, and are not used.
pub const DOUBTED_BODY_RATES: Flags = Flags::bit(53);
/// A fix of satellite navigation is not used: no aircraft can be there, or as fast.
pub const IMPOSSIBLE_FIX: Flags = Flags::bit(54);
/// The magnetic field turns otherwise than the gyroscopes say: they are not used.
pub const DOUBTED_GYROSCOPE: Flags = Flags::bit(55);
/// The satellite receiver only repeats its place, and is not used.
pub const REPEATED_FIX: Flags = Flags::bit(56);
/// The magnetometer only repeats its field, and is not used.
pub const REPEATED_FIELD: Flags = Flags::bit(57);
/// The gyroscopes cannot be compared with the magnetic field yet.
pub const UNCHECKED_GYROSCOPE: Flags = Flags::bit(58);
/// An inertial unit was left for another one.
pub const LEFT_UNIT: Flags = Flags::bit(59);
/// Of several magnetometers, barometers or receivers one is wrong.
pub const WRONG_SENSOR: Flags = Flags::bit(60);
/// The plan needs a position, and none is measured; or there is no plan.
pub const POSITION: Flags = Flags::bit(61);
/// The mode over the ground flies by dead reckoning.
pub const DEAD_RECKONING: Flags = Flags::bit(62);
/// The battery is low, or not measured, and the aircraft stands.
pub const BATTERY: Flags = Flags::bit(63);
/// What of attitude and body rates is doubted.
pub(super) const DOUBTED_MOTION: Flags =
    Flags::from_bits(DOUBTED_ATTITUDE.bits() | DOUBTED_BODY_RATES.bits());

/// The conditions that a quantity is too old, and that it is frozen.
const OF_QUANTITIES: [(Quantity, Flags, Flags); Quantity::COUNT] = [
    (Quantity::Attitude, ATTITUDE, FROZEN_ATTITUDE),
    (Quantity::Heading, HEADING, FROZEN_HEADING),
    (Quantity::BodyRates, BODY_RATES, FROZEN_BODY_RATES),
    (
        Quantity::SpecificForce,
        SPECIFIC_FORCE,
        FROZEN_SPECIFIC_FORCE,
    ),
    (Quantity::Airspeed, AIRSPEED, FROZEN_AIRSPEED),
    // No altimeter is called frozen: other monitors find one that stands still.
    (Quantity::Altitude, ALTITUDE, Flags::NONE),
];

/// The conditions that these are too old.
pub(super) fn too_old(quantities: Quantities) -> Flags {
    OF_QUANTITIES
        .into_iter()
        .fold(Flags::NONE, |all, (quantity, too_old, _)| {
            all.with(too_old, quantities.contains(quantity))
        })
}

/// The conditions that these are frozen.
pub(super) fn frozen(quantities: Quantities) -> Flags {
    OF_QUANTITIES
        .into_iter()
        .fold(Flags::NONE, |all, (quantity, _, frozen)| {
            all.with(frozen, quantities.contains(quantity))
        })
}

/// What is not about a quantity that control needs: nothing is held without it.
pub(super) const NOT_SENSED: Flags = Flags::from_bits(
    !(ATTITUDE.bits()
        | HEADING.bits()
        | BODY_RATES.bits()
        | SPECIFIC_FORCE.bits()
        | AIRSPEED.bits()
        | ALTITUDE.bits()
        | FROZEN_ATTITUDE.bits()
        | FROZEN_HEADING.bits()
        | FROZEN_BODY_RATES.bits()
        | FROZEN_SPECIFIC_FORCE.bits()
        | FROZEN_AIRSPEED.bits()
        | REJECTED.bits()
        | DOUBTED_AIRSPEED.bits()
        | DOUBTED_ALTITUDE.bits()
        | DOUBTED_MOTION.bits()
        | DOUBTED_GYROSCOPE.bits()
        | FROM_THE_FUTURE.bits()
        | SOURCE_CLOCK.bits()),
);

/// The text of each bit, lowest first.
pub(super) const NAMES: [&str; 64] = [
    "attitude is missing or too old",
    "heading is missing or too old",
    "body rates are missing or too old",
    "acceleration is missing or too old",
    "airspeed is missing or too old",
    "altitude is missing or too old",
    "simulator time jumped",
    "simulator is paused",
    "airspeed is below the floor: fly faster than envelope.min_airspeed_kt; a take-off begins standing, where its runway begins",
    "bank or pitch is beyond 60 degrees, or it spins",
    "simulator time has stopped",
    "engage switch is silent",
    "navigation is settling: engage again some seconds later",
    "attitude is frozen",
    "heading is frozen",
    "body rates are frozen",
    "acceleration is frozen",
    "airspeed is frozen",
    "not used (bit 18)",
    "measured values are implausible",
    "nothing arrives from the simulator",
    "the simulator was reloaded",
    "not used (bit 22)",
    "the simulator shows a replay",
    "another autopilot is on",
    "not used (bit 25)",
    "not used (bit 26)",
    "not used (bit 27)",
    "not used (bit 28)",
    "not used (bit 29)",
    "simulator time runs more than twice as fast",
    "not used (bit 31)",
    "airspeed contradicts the other sensors and is not used",
    "recovering from an upset",
    "oscillation: gain is reduced",
    "the outputs take effect too late for the gains",
    "the outputs do not reach the aircraft",
    "too little energy: speed is held, height given up",
    "a reading is from the future",
    "flying on without a lost quantity",
    "the target altitude is limited by the floor or the fence",
    "the pilot moves the controls",
    "readings arrive too old, by their source's own clock",
    "altitude contradicts the other sensors and is not used",
    "levelling and trimming before the release",
    "the elevator trim does not follow",
    "the release cannot trim: hold the elevator",
    "not used (bit 47)",
    "the wing stalls above the configured speed: flying faster",
    "body rates contradict attitude or heading: check signs, axes, units and offsets of both",
    "vertical acceleration contradicts gravity: check its sign and unit, and those of pitch and roll",
    "forward acceleration contradicts pitch and airspeed: check signs and units, and the pitch's offset",
    "attitude contradicts body rates, forces and heading and is not used",
    "body rates contradict attitude, forces and heading and are not used",
    "satellite navigation gives an impossible position or velocity and is not used",
    "gyroscope contradicts the magnetic field and is not used",
    "satellite navigation repeats its position in motion and is not used",
    "magnetometer repeats its field in motion and is not used",
    "gyroscope is not yet compared with the magnetic field: engage again some seconds later",
    "an inertial unit was wrong or silent and is not used again",
    "a magnetometer, a barometer or a satellite receiver was wrong and is not used again",
    "position is missing, which the plan needs",
    "position is by dead reckoning: satellite navigation is silent",
    "the battery is low, or what limits it in [contingency] is not measured",
];
