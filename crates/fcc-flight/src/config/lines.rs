//! Receivers on serial lines, of satellites and of a transmitter.

use std::path::PathBuf;

use fcc_core::framework::FALLBACK_AFTER;
use fcc_linux::serial::{GnssSettings, LineSettings, RcChannel, RcChannels, RcProtocol};
use serde::{Deserialize, Serialize};

use super::CalibrationSection;

/// A satellite receiver.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct GnssSerialSection {
    /// Its line.
    pub path: PathBuf,
    /// Bits in a second.
    pub baud: u32,
    /// Whether it is configured as a receiver of u-blox, from generation 9 on.
    pub configure: bool,
    /// It counts as silent after this long without a fix.
    pub silent_after_ms: u64,
    /// After this long without a fix, that of the next sensor is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings: its delay.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

/// An RC receiver: engage switch and the pilot's sticks.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RcReceiverSection {
    /// Its line.
    pub path: PathBuf,
    /// What it speaks.
    pub protocol: RcProtocol,
    /// The channel of the engage switch, from 1; negative if it is reversed, as
    /// for all channels.
    pub switch_channel: i8,
    /// The pulse above which the switch is on.
    pub switch_on_above_us: f64,
    /// The channels of the sticks; 0 if they are not used.
    pub pitch_channel: i8,
    /// That of roll.
    pub roll_channel: i8,
    /// That of yaw.
    pub yaw_channel: i8,
    /// It counts as silent after this long without a frame.
    pub silent_after_ms: u64,
    /// After this long without one, the next sensor's sticks are used.
    pub fallback_after_ms: u64,
}

impl Default for GnssSerialSection {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            baud: 38_400,
            configure: true,
            silent_after_ms: 2_000,
            fallback_after_ms: 1_000,
            calibration: CalibrationSection::default(),
        }
    }
}

impl Default for RcReceiverSection {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            protocol: RcProtocol::Sbus,
            switch_channel: 5,
            switch_on_above_us: 1_700.0,
            pitch_channel: 2,
            roll_channel: 1,
            yaw_channel: 4,
            silent_after_ms: 500,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
        }
    }
}

impl GnssSerialSection {
    /// What opens it.
    pub fn to_linux(&self) -> GnssSettings {
        GnssSettings {
            line: LineSettings {
                path: self.path.clone(),
                baud: self.baud,
                has_even_parity: false,
            },
            configures: self.configure,
        }
    }
}

impl RcReceiverSection {
    /// What its channels are.
    pub fn channels(&self) -> RcChannels {
        let channel = |number: i8| RcChannel {
            number: number.unsigned_abs(),
            is_reversed: number < 0,
        };
        let sticks = [self.pitch_channel, self.roll_channel, self.yaw_channel];
        RcChannels {
            switch: channel(self.switch_channel),
            on_above_us: self.switch_on_above_us,
            controls: (!sticks.contains(&0)).then(|| sticks.map(channel)),
        }
    }
}
