//! The datagrams by which surfaces, throttles and overrides are written.
//!
//! No override has a timeout: X-Plane would keep the last deflection.
//! A release therefore centres the surfaces and then clears the overrides, in
//! this order. The throttle has no centre position: it stays where it is until
//! its override is cleared and the lever in the cockpit has control again. The
//! elevator's trim, the flaps and the gear need no override, and stay where they are. The
//! brakes' override is set with the first brake that is written.

use fcc_core::flight::Surfaces;

use crate::config::{Output, PlantKind, XPlaneConfig};
use crate::deflections::Deflections;
use crate::port::Errno;
use crate::protocol::{PathError, data, dref};
use crate::quantity::{ELEVATOR_TRIM, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES};
use crate::quantity::{YOKE_HEADING, YOKE_PITCH, YOKE_ROLL};

const THROTTLE: &str = "sim/flightmodel/engine/ENGN_thro_use";
const OVERRIDE_BRAKES: &str = "sim/operation/override/override_toe_brakes";
/// What is written only when it is given: each tick the first ones of what there is.
pub(crate) const OCCASIONAL: [&str; 6] = [
    ELEVATOR_TRIM,
    "sim/cockpit2/controls/flap_ratio",
    OVERRIDE_BRAKES,
    "sim/cockpit2/controls/left_brake_ratio",
    "sim/cockpit2/controls/right_brake_ratio",
    "sim/cockpit2/controls/gear_handle_down",
];
/// A servo board gets flaps, brakes and gear in one of so many datagrams: a slow serial line
/// has no room for them in each.
const WHEELS_EVERY: u8 = 8;

/// How often the release is sent in a row: datagrams get lost, and afterwards
/// there may be no program left to repeat it.
pub(crate) const LET_GO_TIMES: usize = 3;

/// Three surfaces, the throttles of eight engines, the maximum of
/// [`XPlaneConfig::engines`], and what is occasional.
const MOST_WRITES: usize = 11 + OCCASIONAL.len();

type Write = Box<[u8; dref::WRITE_BYTES]>;

/// The datagrams, built once: a tick only changes the numbers in them.
#[derive(Clone, Debug)]
pub(crate) struct Controls {
    overrides: [Write; 2],
    encoding: Encoding,
    /// What is occasional, beside rows.
    occasional: [Write; OCCASIONAL.len()],
    /// Clears the brakes' override, once it was set.
    brakes: Write,
    has_brakes: bool,
}

#[derive(Clone, Debug)]
enum Encoding {
    Dref {
        /// Elevator, aileron, rudder, the throttles, then what is occasional:
        /// contiguous, so that one system call can send them.
        writes: Box<[[u8; dref::WRITE_BYTES]]>,
    },
    Data {
        engines: usize,
        datagram: [u8; data::size(4)],
        /// Of a servo board, where flaps, brakes and gear are rows, too: datagrams since
        /// they were in one, up to [`WHEELS_EVERY`].
        wheels: Option<u8>,
    },
}

impl Encoding {
    const fn is_of_board(&self) -> bool {
        matches!(
            self,
            Self::Data {
                wheels: Some(_),
                ..
            }
        )
    }
}

impl Controls {
    pub(crate) fn new(config: &XPlaneConfig) -> Result<Self, PathError> {
        let engines = usize::from(config.engines);
        let encoding = match config.output {
            Output::Dref => {
                let yoke = [YOKE_PITCH, YOKE_ROLL, YOKE_HEADING].map(str::to_owned);
                let throttles = (0..engines).map(|engine| format!("{THROTTLE}[{engine}]"));
                let writes = yoke
                    .into_iter()
                    .chain(throttles)
                    .chain(OCCASIONAL.map(str::to_owned))
                    .map(|path| write_to(&path).map(|write| *write))
                    .collect::<Result<_, _>>()?;
                Encoding::Dref { writes }
            }
            Output::Data => Encoding::Data {
                engines,
                datagram: [0; data::size(4)],
                wheels: (config.plant == PlantKind::ServoBoard).then_some(0),
            },
        };
        Ok(Self {
            overrides: [write_to(OVERRIDE_JOYSTICK)?, write_to(OVERRIDE_THROTTLES)?],
            encoding,
            occasional: {
                let [trim, flaps, overrides, left, right, gear] = OCCASIONAL.map(write_to);
                [trim?, flaps?, overrides?, left?, right?, gear?]
            },
            brakes: write_to(OVERRIDE_BRAKES)?,
            has_brakes: false,
        })
    }

    /// Sets the overrides.
    pub(crate) fn take(
        &mut self,
        mut send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        self.set_overrides(1.0, &mut send)
    }

    /// Writes surfaces and throttles. A slice given to `send` may hold several
    /// contiguous datagrams of [`dref::WRITE_BYTES`].
    pub(crate) fn set(
        &mut self,
        surfaces: &Surfaces,
        mut send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        // A board has no override of its own for them.
        let is_simulator = !self.encoding.is_of_board();
        self.has_brakes |= is_simulator && surfaces.left_brake.or(surfaces.right_brake).is_some();
        self.deflect(Deflections::of(surfaces), &mut send)
    }

    /// The number of datagrams that [`set`](Self::set) sends.
    pub(crate) fn messages(&self, surfaces: &Surfaces) -> usize {
        let given = Deflections::of(surfaces).occasional;
        let occasional = given.iter().flatten().count();
        match &self.encoding {
            Encoding::Dref { writes } => writes.len() - OCCASIONAL.len() + occasional,
            Encoding::Data { .. } if self.encoding.is_of_board() => 1,
            Encoding::Data { .. } => 1 + occasional,
        }
    }

    /// Encodes into a buffer on the stack what [`set`](Self::set) would write.
    pub(crate) fn warm_up(&self, surfaces: &Surfaces, mut send: impl FnMut(&[u8])) {
        let Encoding::Dref { writes } = &self.encoding else {
            return;
        };
        let mut buffer = [[0; dref::WRITE_BYTES]; MOST_WRITES];
        if let Some(scratch) = buffer.get_mut(..writes.len()) {
            scratch.copy_from_slice(writes);
            let set = set_values(scratch, &Deflections::of(surfaces));
            send(scratch.get(..set).unwrap_or_default().as_flattened());
        }
    }

    /// Centres the surfaces, then clears the overrides, once.
    pub(crate) fn release(
        &mut self,
        mut send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        let centred = self.deflect(Deflections::CENTRED, &mut send);
        // With rows, "leave as it is" in every column also ends what the row
        // itself may have overridden.
        let left = match self.encoding {
            Encoding::Dref { .. } => Ok(()),
            Encoding::Data { .. } => self.deflect(Deflections::AS_THEY_ARE, &mut send),
        };
        let mut released = self.set_overrides(0.0, &mut send);
        if self.has_brakes {
            released = released.and(send(self.brakes.as_slice()));
        }
        centred.and(left).and(released)
    }

    fn set_overrides(
        &mut self,
        value: f32,
        send: &mut impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        let mut outcome = Ok(());
        for write in &mut self.overrides {
            dref::set_value(write, value);
            outcome = outcome.and(send(write.as_slice()));
        }
        outcome
    }

    /// Sends every datagram even if one fails, and returns the first failure.
    fn deflect(
        &mut self,
        to: Deflections,
        send: &mut impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        let mut outcome = Ok(());
        match &mut self.encoding {
            Encoding::Dref { writes } => {
                let set = set_values(writes, &to);
                // None behind the first that is missing.
                if to
                    .values(writes.len())
                    .skip(set)
                    .all(|value| value.is_none())
                    && set > 3
                {
                    return send(writes.get(..set).unwrap_or_default().as_flattened());
                }
                for (write, value) in writes.iter().zip(to.values(writes.len())) {
                    if value.is_some() {
                        outcome = outcome.and(send(write.as_slice()));
                    }
                }
            }
            Encoding::Data {
                engines,
                datagram,
                wheels,
            } => {
                let all = to.rows(*engines);
                let mut rows = all.get(..2);
                if let Some(since) = wheels {
                    let moves = to.moves_wheels();
                    if moves && *since == 0 {
                        rows = Some(&all);
                    }
                    *since = if moves {
                        (*since + 1) % WHEELS_EVERY
                    } else {
                        0
                    };
                }
                if let Some(datagram) = rows.and_then(|rows| data::write(datagram, rows)) {
                    outcome = send(datagram);
                }
                if wheels.is_some() {
                    return outcome;
                }
                for (write, value) in self.occasional.iter_mut().zip(to.occasional) {
                    if let Some(value) = value {
                        dref::set_value(write, value);
                        outcome = outcome.and(send(write.as_slice()));
                    }
                }
            }
        }
        outcome
    }
}

/// Sets the values that there are; returns how many of the first have one.
fn set_values(writes: &mut [[u8; dref::WRITE_BYTES]], to: &Deflections) -> usize {
    let values = to.values(writes.len());
    for (write, value) in writes.iter_mut().zip(values) {
        if let Some(value) = value {
            dref::set_value(write, value);
        }
    }
    to.values(writes.len()).take_while(Option::is_some).count()
}

fn write_to(path: &str) -> Result<Write, PathError> {
    let mut write = Box::new([0; dref::WRITE_BYTES]);
    dref::write(&mut write, 0.0, path)?;
    Ok(write)
}

#[cfg(test)]
mod tests;
