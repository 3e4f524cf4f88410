//! The twenty steps, in their order.

mod altimeter;
mod autopilot;
mod ends;
mod engaging;
mod freezes;
mod network;
mod paths;
mod pattern;
mod signs;
mod stops;
mod time;

use crate::step::Step;
pub(crate) use network::NO_ANSWER;

/// The steps.
pub const STEPS: [Step; 20] = [
    network::READY,
    network::PORTS,
    network::INCOMING,
    network::FIREWALL,
    signs::PARKED,
    signs::TURN,
    signs::DIRECTIONS,
    engaging::LIGHTS,
    engaging::BUMP,
    engaging::JOYSTICK,
    pattern::PATTERN,
    stops::PAUSE,
    stops::WINDOWS,
    stops::REPLAY,
    altimeter::ALTIMETER,
    autopilot::AUTOPILOT,
    time::TIME,
    freezes::FREEZE_STEP,
    freezes::RELOAD,
    ends::ENDS,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_numbered_in_their_order() {
        for (place, step) in STEPS.iter().enumerate() {
            assert_eq!(usize::from(step.number), place + 1, "{}", step.title);
        }
    }
}
