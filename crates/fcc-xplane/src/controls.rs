//! The datagrams by which surfaces, throttles and overrides are written.
//!
//! No override has a timeout: X-Plane would keep the last deflection.
//! A release therefore centres the surfaces and then clears the overrides, in
//! this order. The throttle has no centre position: it stays where it is until
//! its override is cleared and the lever in the cockpit has control again. The
//! elevator's trim and the flaps need no override, and stay where they are. The
//! brakes' override is set with the first brake that is written.

use fcc_core::flight::Surfaces;

use crate::config::{Output, XPlaneConfig};
use crate::deflections::Deflections;
use crate::port::Errno;
use crate::protocol::{PathError, data, dref};
use crate::quantity::{ELEVATOR_TRIM, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES};
use crate::quantity::{YOKE_HEADING, YOKE_PITCH, YOKE_ROLL};

const THROTTLE: &str = "sim/flightmodel/engine/ENGN_thro_use";
const OVERRIDE_BRAKES: &str = "sim/operation/override/override_toe_brakes";
/// What is written only when it is given: each tick the first ones of what there is.
pub(crate) const OCCASIONAL: [&str; 5] = [
    ELEVATOR_TRIM,
    "sim/cockpit2/controls/flap_ratio",
    OVERRIDE_BRAKES,
    "sim/cockpit2/controls/left_brake_ratio",
    "sim/cockpit2/controls/right_brake_ratio",
];
/// Rows of Data Output.
const ROW_JOYSTICK: i32 = 8;
const ROW_THROTTLES: i32 = 25;

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
        datagram: [u8; data::size(2)],
    },
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
                datagram: [0; data::size(2)],
            },
        };
        Ok(Self {
            overrides: [write_to(OVERRIDE_JOYSTICK)?, write_to(OVERRIDE_THROTTLES)?],
            encoding,
            occasional: {
                let [trim, flaps, overrides, left, right] = OCCASIONAL.map(write_to);
                [trim?, flaps?, overrides?, left?, right?]
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
        self.has_brakes |= surfaces.left_brake.or(surfaces.right_brake).is_some();
        self.deflect(Deflections::of(surfaces), &mut send)
    }

    /// The number of datagrams that [`set`](Self::set) sends.
    pub(crate) fn messages(&self, surfaces: &Surfaces) -> usize {
        let given = Deflections::of(surfaces).occasional;
        let occasional = given.iter().flatten().count();
        match &self.encoding {
            Encoding::Dref { writes } => writes.len() - OCCASIONAL.len() + occasional,
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
            Encoding::Data { engines, datagram } => {
                let [elevator, aileron, rudder] = to.yoke;
                let joystick = [elevator, aileron, rudder, None, None, None, None, None];
                let throttles =
                    core::array::from_fn(|engine| to.throttle.filter(|_| engine < *engines));
                let rows = [(ROW_JOYSTICK, joystick), (ROW_THROTTLES, throttles)]
                    .map(|(index, columns)| data::Row { index, columns });
                if let Some(datagram) = data::write(datagram, &rows) {
                    outcome = send(datagram);
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
mod tests {
    use super::*;

    /// The datagrams that were sent.
    fn sent(act: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<(), Errno>)) -> Vec<Vec<u8>> {
        let mut datagrams = Vec::new();
        act(&mut |datagram| {
            let each = datagram.chunks(dref::WRITE_BYTES);
            datagrams.extend(each.map(<[u8]>::to_vec));
            Ok(())
        });
        datagrams
    }

    fn named(datagrams: &[Vec<u8>]) -> Vec<(String, f32)> {
        datagrams
            .iter()
            .map(|datagram| {
                assert_eq!(datagram.len(), 509);
                assert_eq!(&datagram[..5], b"DREF\0");
                let value = f32::from_le_bytes(datagram[5..9].try_into().unwrap());
                let path = datagram[9..].split(|byte| *byte == 0).next().unwrap();
                (String::from_utf8(path.to_vec()).unwrap(), value)
            })
            .collect()
    }

    const SURFACES: Surfaces = Surfaces {
        throttle: 0.75,
        elevator: 0.5,
        aileron: -0.25,
        rudder: 0.125,
        ..Surfaces::IDLE
    };

    #[test]
    fn each_surface_and_engine_is_written_separately() {
        let config = XPlaneConfig {
            engines: 2,
            ..XPlaneConfig::default()
        };
        let mut controls = Controls::new(&config).unwrap();
        let writes = named(&sent(|send| controls.set(&SURFACES, send).unwrap()));
        let expected = [
            ("sim/joystick/yoke_pitch_ratio", 0.5),
            ("sim/joystick/yoke_roll_ratio", -0.25),
            ("sim/joystick/yoke_heading_ratio", 0.125),
            ("sim/flightmodel/engine/ENGN_thro_use[0]", 0.75),
            ("sim/flightmodel/engine/ENGN_thro_use[1]", 0.75),
        ];
        assert_eq!(writes, expected.map(|(path, v)| (path.to_owned(), v)));
    }

    #[test]
    fn a_release_centres_first_and_clears_the_overrides_last() {
        let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
        sent(|send| controls.set(&SURFACES, send).unwrap());
        let writes = named(&sent(|send| controls.release(send).unwrap()));
        let expected = [
            "sim/joystick/yoke_pitch_ratio",
            "sim/joystick/yoke_roll_ratio",
            "sim/joystick/yoke_heading_ratio",
            "sim/operation/override/override_joystick",
            "sim/operation/override/override_throttles",
        ];
        assert_eq!(writes, expected.map(|path| (path.to_owned(), 0.0)));
    }

    #[test]
    fn the_trim_is_written_last_and_stays_at_a_release() {
        for output in [Output::Dref, Output::Data] {
            let config = XPlaneConfig {
                output,
                ..XPlaneConfig::default()
            };
            let mut controls = Controls::new(&config).unwrap();
            let trimmed = Surfaces {
                elevator_trim: Some(-0.375),
                ..SURFACES
            };
            let mut datagrams = sent(|send| controls.set(&trimmed, send).unwrap());
            let last = named(&[datagrams.pop().unwrap()]);
            let expected = ("sim/flightmodel/controls/elv_trim".to_owned(), -0.375);
            assert_eq!(last, [expected]);
            let without = sent(|send| controls.set(&SURFACES, send).unwrap());
            assert_eq!(without, datagrams);
            let released = sent(|send| controls.release(send).unwrap());
            assert!(!released.concat().windows(8).any(|path| path == b"elv_trim"));
        }
    }

    #[test]
    fn by_rows_it_is_one_datagram_with_joystick_and_throttles() {
        let config = XPlaneConfig {
            output: Output::Data,
            engines: 2,
            ..XPlaneConfig::default()
        };
        let mut controls = Controls::new(&config).unwrap();
        let datagrams = sent(|send| controls.set(&SURFACES, send).unwrap());
        let mut expected = b"DATA\0\x08\0\0\0".to_vec();
        for column in [
            0.5_f32, -0.25, 0.125, -999.0, -999.0, -999.0, -999.0, -999.0,
        ] {
            expected.extend(column.to_le_bytes());
        }
        expected.extend([25, 0, 0, 0]);
        for column in [
            0.75_f32, 0.75, -999.0, -999.0, -999.0, -999.0, -999.0, -999.0,
        ] {
            expected.extend(column.to_le_bytes());
        }
        assert_eq!(datagrams, [expected]);
    }

    #[test]
    fn values_out_of_range_are_limited_or_not_sent() {
        let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
        let surfaces = Surfaces {
            throttle: -3.0,
            elevator: f64::NAN,
            aileron: f64::INFINITY,
            rudder: -7.0,
            elevator_trim: Some(1.5),
            ..Surfaces::IDLE
        };
        let writes = named(&sent(|send| controls.set(&surfaces, send).unwrap()));
        let expected = [
            ("sim/joystick/yoke_roll_ratio", 1.0),
            ("sim/joystick/yoke_heading_ratio", -1.0),
            ("sim/flightmodel/engine/ENGN_thro_use[0]", 0.0),
            ("sim/flightmodel/controls/elv_trim", 1.0),
        ];
        assert_eq!(writes, expected.map(|(path, v)| (path.to_owned(), v)));
    }

    #[test]
    fn one_refused_datagram_does_not_prevent_the_others() {
        let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
        let mut tried = 0;
        let outcome = controls.release(|_| {
            tried += 1;
            if tried == 1 { Err(11) } else { Ok(()) }
        });
        assert_eq!((outcome, tried), (Err(11), 5));
    }
}
