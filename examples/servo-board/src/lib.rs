//! The loop of a servo board's firmware: a UART, a pitot tube, a switch, the
//! servos of the surfaces, of flaps, of brakes and of a gear. `no_std`; what it takes for a certain microcontroller is a
//! [`Hardware`] of it.
//!
//! ```sh
//! cargo build -p servo-board-firmware --target thumbv6m-none-eabi
//! ```
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

use fcc_servo_board::{
    Board, BoardConfig, Control, Decoder, Encoder, MAX_FRAME, MAX_MESSAGE, Readings,
};

/// What the microcontroller has. Nothing here may wait.
pub trait Hardware {
    /// The time since any event, ms; may wrap around.
    fn now_ms(&mut self) -> u32;
    /// The next byte that the UART received, if there is one.
    fn received(&mut self) -> Option<u8>;
    /// Sends bytes by the UART; what does not fit its buffer is lost.
    fn send(&mut self, bytes: &[u8]);
    /// The last differential pressure, Pa; none if the sensor does not answer.
    fn differential_pressure_pa(&mut self) -> Option<f32>;
    /// The engage switch, debounced.
    fn is_switched_on(&mut self) -> bool;
    /// Sets the pulses of elevator, aileron, rudder, throttle, flaps, left and right
    /// brake, and gear, µs. A nose wheel is connected to the rudder.
    fn set_pulses_us(&mut self, pulses: [f32; 8]);
    /// Restarts the watchdog timer.
    fn feed_watchdog(&mut self);
}

/// A servo's middle position and its travel to either side, and the position of an
/// idle throttle, flaps and a gear that are up and a brake that is released, and their travel, µs.
const MIDDLE_US: f32 = 1_500.0;
const TRAVEL_US: f32 = 500.0;
const IDLE_US: f32 = 1_000.0;
const FULL_US: f32 = 1_000.0;

/// The firmware's state.
pub struct Firmware {
    board: Board,
    decoder: Decoder,
    encoder: Encoder,
    config: BoardConfig,
}

impl Default for Firmware {
    fn default() -> Self {
        let config = BoardConfig::default();
        Self {
            board: Board::new(config),
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            config,
        }
    }
}

impl Firmware {
    /// One pass, to be called every few milliseconds; returns who has control,
    /// for a lamp.
    pub fn step(&mut self, hardware: &mut impl Hardware) -> Control {
        let now_ms = hardware.now_ms();
        while let Some(byte) = hardware.received() {
            if let Some(message) = self.decoder.push(byte) {
                // The board goes on as before if a message is not for it.
                let _ = self.board.receive(now_ms, (), message);
            }
        }
        let readings = Readings {
            differential_pressure_pa: hardware.differential_pressure_pa(),
            engage_switch: Some(hardware.is_switched_on()),
            ..Readings::default()
        };
        let mut message = [0; MAX_MESSAGE];
        let mut frame = [0; MAX_FRAME];
        let reply = self.board.poll(now_ms, &readings, &mut message);
        if let Some(bytes) = reply.and_then(|reply| self.encoder.frame(reply, &mut frame)) {
            hardware.send(bytes);
        }
        let drive = self.board.drive();
        let safe = self.config.failsafe;
        // Without a receiver, nobody drives to where the failsafe does.
        let [elevator, aileron, rudder] =
            drive
                .surfaces
                .unwrap_or([safe.elevator, safe.aileron, safe.rudder]);
        let throttle = drive.throttle.unwrap_or(safe.throttle);
        let flaps = drive.flaps.unwrap_or(0.0);
        let [left, right] = drive.brakes.unwrap_or_default();
        let gear = drive.gear.unwrap_or(1.0);
        hardware.set_pulses_us([
            MIDDLE_US + TRAVEL_US * elevator,
            MIDDLE_US + TRAVEL_US * aileron,
            MIDDLE_US + TRAVEL_US * rudder,
            IDLE_US + FULL_US * throttle,
            IDLE_US + FULL_US * flaps,
            IDLE_US + FULL_US * left,
            IDLE_US + FULL_US * right,
            IDLE_US + FULL_US * gear,
        ]);
        hardware.feed_watchdog();
        drive.control
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    #[derive(Default)]
    struct Bench {
        now_ms: u32,
        line: VecDeque<u8>,
        sent: Vec<u8>,
        pulses: [f32; 8],
        fed: u32,
    }

    impl Hardware for Bench {
        fn now_ms(&mut self) -> u32 {
            self.now_ms
        }

        fn received(&mut self) -> Option<u8> {
            self.line.pop_front()
        }

        fn send(&mut self, bytes: &[u8]) {
            self.sent.extend(bytes);
        }

        fn differential_pressure_pa(&mut self) -> Option<f32> {
            Some(198.0)
        }

        fn is_switched_on(&mut self) -> bool {
            true
        }

        fn set_pulses_us(&mut self, pulses: [f32; 8]) {
            self.pulses = pulses;
        }

        fn feed_watchdog(&mut self) {
            self.fed += 1;
        }
    }

    fn dref(path: &str, value: f32) -> Vec<u8> {
        [b"DREF\0", &value.to_le_bytes()[..], path.as_bytes()].concat()
    }

    #[test]
    fn servos_follow_and_go_to_the_failsafe_200_ms_after_the_last_write() {
        let (mut firmware, mut bench) = (Firmware::default(), Bench::default());
        let mut line = Encoder::new();
        assert_eq!(firmware.step(&mut bench), Control::Free);
        let idle = [
            1_500.0, 1_500.0, 1_500.0, 1_000.0, 1_000.0, 1_000.0, 1_000.0, 2_000.0,
        ];
        assert_eq!(bench.pulses, idle);
        for message in [
            b"RREF\0\x32\0\0\0\x01\0\0\0fccd/servo_board/differential_pressure_pa".to_vec(),
            dref("sim/operation/override/override_joystick", 1.0),
            dref("sim/operation/override/override_throttles", 1.0),
            dref("sim/joystick/yoke_pitch_ratio", 1.0),
            dref("sim/joystick/yoke_roll_ratio", -1.0),
            dref("sim/joystick/yoke_heading_ratio", 0.5),
            dref("sim/flightmodel/engine/ENGN_thro_use[0]", 0.25),
            dref("sim/cockpit2/controls/flap_ratio", 0.5),
            dref("sim/cockpit2/controls/left_brake_ratio", 0.0),
            dref("sim/cockpit2/controls/right_brake_ratio", 0.75),
            dref("sim/cockpit2/controls/gear_handle_down", 0.0),
        ] {
            let mut frame = [0; MAX_FRAME];
            bench.line.extend(line.frame(&message, &mut frame).unwrap());
        }
        bench.now_ms = 20;
        assert_eq!(firmware.step(&mut bench), Control::Held);
        let surfaces = [2_000.0, 1_000.0, 1_750.0, 1_250.0];
        assert_eq!(bench.pulses[..4], surfaces);
        assert_eq!(bench.pulses[4..], [1_500.0, 1_000.0, 1_750.0, 1_000.0]);
        let mut computer = Decoder::new();
        let mut replies = Vec::new();
        for byte in &bench.sent {
            replies.extend(computer.push(*byte).map(<[u8]>::to_vec));
        }
        let value = [b"RREF,\x01\0\0\0", &198.0_f32.to_le_bytes()[..]].concat();
        assert_eq!(replies, [value]);
        bench.now_ms = 219;
        assert_eq!(firmware.step(&mut bench), Control::Held);
        bench.now_ms = 220;
        assert_eq!(firmware.step(&mut bench), Control::Failsafe);
        assert_eq!(bench.pulses[..4], idle[..4]);
        // Flaps and brakes stay; the gear is down.
        assert_eq!(bench.pulses[4..], [1_500.0, 1_000.0, 1_750.0, 2_000.0]);
        assert_eq!(bench.fed, 4);
    }
}
