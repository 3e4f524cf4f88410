//! The pilot's switch and sticks, from the channels of an RC receiver.

use fcc_core::flight::{Measurements, PilotControls};
use fcc_core::framework::{Reading, Switch};

use super::channels::{CHANNELS, ReceiverFrame, position, pulse_us};
use crate::{Measured, Sample};

/// A change of the switch counts after so many frames in a row: SBUS has no
/// checksum.
const FRAMES_FOR_A_CHANGE: u32 = 3;
/// Twice the middle of a channel, µs.
const MIRROR_US: f64 = 3_000.0;

/// A channel of the pilot's.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RcChannel {
    /// 1 to 16; others read as the middle.
    pub number: u8,
    /// Whether its sense is the other one.
    pub is_reversed: bool,
}

/// What the channels are.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RcChannels {
    /// The engage switch.
    pub switch: RcChannel,
    /// The switch is on above this, µs; reversed, below 3,000 minus this.
    pub on_above_us: f64,
    /// Pitch, roll and yaw, if they are used.
    pub controls: Option<[RcChannel; 3]>,
}

/// What the pilot does with a transmitter.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RcValues {
    /// The engage switch: off if the receiver has lost the transmitter. None until
    /// it is known.
    pub switch: Option<Switch>,
    /// The sticks; none if they are not used, or the transmitter is lost.
    pub controls: Option<PilotControls>,
}

impl Measured for RcValues {
    fn write(sample: &Sample<Self>, into: &mut Measurements) {
        if let Some(switch) = sample.value.switch {
            into.engage_switch = Reading::new(switch, sample.taken);
        }
        if let Some(controls) = sample.value.controls {
            into.pilot_controls = Reading::new(controls, sample.taken);
        }
    }
}

/// Follows the frames of a receiver.
///
/// A transmitter that is lost (SBUS: failsafe; CRSF: a link quality of 0 %) is a
/// switch that is off, and stays so until the pilot has switched it off: the loop
/// must not take control because a radio link is back. A receiver that repeats its last channels (SBUS: frame lost)
/// says nothing, and the age of the readings decides.
#[derive(Clone, Debug)]
pub struct Pilot {
    channels: RcChannels,
    /// By the link statistics of CRSF.
    is_link_lost: bool,
    switch: Option<Switch>,
    /// The switch of the latest frame, and how many in a row had it.
    latest: (Switch, u32),
    /// The transmitter was lost, and its switch has not been off since.
    must_go_off: bool,
}

impl Pilot {
    /// Nothing is known yet.
    pub const fn new(channels: RcChannels) -> Self {
        Self {
            channels,
            is_link_lost: false,
            switch: None,
            latest: (Switch::Off, 0),
            must_go_off: false,
        }
    }

    /// Takes a frame; none if it says nothing of the pilot.
    pub fn take(&mut self, frame: &ReceiverFrame) -> Option<RcValues> {
        match frame {
            ReceiverFrame::Link { quality_percent } => {
                self.is_link_lost = *quality_percent == 0;
                self.is_link_lost.then(|| self.lost())
            }
            ReceiverFrame::Channels {
                is_failsafe: true, ..
            } => Some(self.lost()),
            ReceiverFrame::Channels { is_lost: true, .. } => None,
            ReceiverFrame::Channels { .. } if self.is_link_lost => Some(self.lost()),
            ReceiverFrame::Channels { channels, .. } => Some(self.moved(channels)),
        }
    }

    fn moved(&mut self, channels: &[u16; CHANNELS]) -> RcValues {
        let pulse = pulse_us(value(channels, self.channels.switch));
        let is_on = if self.channels.switch.is_reversed {
            MIRROR_US - pulse > self.channels.on_above_us
        } else {
            pulse > self.channels.on_above_us
        };
        let switch = if is_on { Switch::On } else { Switch::Off };
        let (before, count) = self.latest;
        let count = if switch == before { count } else { 0 };
        self.latest = (switch, count.saturating_add(1));
        if self.latest.1 >= FRAMES_FOR_A_CHANGE {
            self.must_go_off &= switch == Switch::On;
            if !self.must_go_off {
                self.switch = Some(switch);
            }
        }
        let deflection = |channel: RcChannel| {
            let deflection = position(value(channels, channel));
            if channel.is_reversed {
                -deflection
            } else {
                deflection
            }
        };
        let controls = self
            .channels
            .controls
            .map(|[pitch, roll, yaw]| PilotControls {
                pitch: deflection(pitch),
                roll: deflection(roll),
                yaw: deflection(yaw),
            });
        RcValues {
            switch: self.switch,
            controls,
        }
    }

    fn lost(&mut self) -> RcValues {
        self.latest = (Switch::Off, 0);
        self.switch = Some(Switch::Off);
        self.must_go_off = true;
        RcValues {
            switch: self.switch,
            controls: None,
        }
    }
}

const MIDDLE: u16 = 992;

fn value(channels: &[u16; CHANNELS], channel: RcChannel) -> u16 {
    let at = usize::from(channel.number).wrapping_sub(1);
    channels.get(at).copied().unwrap_or(MIDDLE)
}
