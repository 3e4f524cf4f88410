//! Who has the servos, and where they go.

use crate::config::BoardConfig;
use crate::message::{NotForBoard, Reply, Request};
use crate::subscriptions::Subscriptions;
use crate::surfaces::Surfaces;
use crate::value::{Readings, Value};

/// Rows of DATA that are written.
const ROW_JOYSTICK: i32 = 8;
const ROW_THROTTLES: i32 = 25;
/// Their columns 3, and 2 and 3.
const ROW_FLAPS: i32 = 13;
const ROW_BRAKES: i32 = 14;

/// Who has control.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Control {
    /// Nobody, or the pilot's receiver.
    Free,
    /// The computer.
    Held,
    /// The computer had it, and is lost. Its next write takes the servos again.
    Failsafe,
}

/// What drives the servos now. `None` is left to the firmware: the pilot's
/// receiver, or [`BoardConfig::failsafe`] without one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Drive {
    /// Who has control.
    pub control: Control,
    /// Elevator, aileron and rudder, each -1 to 1.
    pub surfaces: Option<[f32; 3]>,
    /// 0 to 1.
    pub throttle: Option<f32>,
    /// 0 up to 1 fully extended, once they were written. In a failsafe they stay.
    pub flaps: Option<f32>,
    /// Of the left and the right wheel, 0 released to 1 full, as the flaps: in the air
    /// they are released.
    pub brakes: Option<[f32; 2]>,
    /// A retractable landing gear, 0 up to 1 down, once it was written: it stays as it
    /// is. In a failsafe it is down.
    pub gear: Option<f32>,
}

/// A servo board. `P` tells computers apart: the address and port over UDP, `()`
/// on a serial line.
///
/// Times are of any clock in milliseconds that goes on evenly; it may begin at 0
/// again after 2³² - 1.
#[derive(Clone, Debug)]
pub struct Board<P = ()> {
    config: BoardConfig,
    /// The computer that requested or wrote last.
    peer: Option<P>,
    subscriptions: Subscriptions,
    /// Of the joystick: elevator, aileron, rudder; of the throttles.
    overrides: [bool; 2],
    /// What was written since the override was set.
    yoke: [Option<f32>; 3],
    throttle: Option<f32>,
    /// Flaps, left and right brake, gear: with the joystick's override.
    wheels: [Option<f32>; 4],
    /// When surfaces or throttle were last written while control was held, or it
    /// was taken.
    written_ms: u32,
    is_lost: bool,
    replied_ms: Option<u32>,
}

impl<P: Copy + PartialEq> Board<P> {
    /// A board that nobody controls.
    pub fn new(config: BoardConfig) -> Self {
        Self {
            config,
            peer: None,
            subscriptions: Subscriptions::default(),
            overrides: [false; 2],
            yoke: [None; 3],
            throttle: None,
            wheels: [None; 4],
            written_ms: 0,
            is_lost: false,
            replied_ms: None,
        }
    }

    /// Takes a message of a computer, with or without padding.
    ///
    /// # Errors
    /// Why it has no effect; the board goes on as before.
    pub fn receive(&mut self, now_ms: u32, from: P, message: &[u8]) -> Result<(), NotForBoard> {
        self.notice_loss(now_ms);
        let request = Request::parse(message)?;
        if self.control() == Control::Held && self.peer.is_some_and(|peer| peer != from) {
            return Err(NotForBoard::Stranger);
        }
        if self.peer != Some(from) {
            self.peer = Some(from);
            self.subscriptions.clear();
        }
        match request {
            Request::Subscribe {
                frequency_hz,
                index,
                path,
            } => self
                .subscriptions
                .subscribe(frequency_hz, index, self.value(path)?),
            Request::Write { path, value } => self.write(now_ms, self.value(path)?, value),
            Request::Rows(rows) => {
                let mut outcome = Ok(());
                for (index, columns) in rows {
                    outcome = outcome.and(self.write_row(now_ms, index, columns));
                }
                outcome
            }
        }
    }

    /// To be called every few milliseconds, at least at twice the rate of
    /// replies: notices that the computer is lost, and returns a message for
    /// [`peer`](Self::peer) if one is due. It is written into the caller's
    /// buffer, of which [`MAX_MESSAGE`](crate::MAX_MESSAGE) bytes are enough.
    pub fn poll<'a>(
        &mut self,
        now_ms: u32,
        readings: &Readings,
        into: &'a mut [u8],
    ) -> Option<&'a [u8]> {
        self.notice_loss(now_ms);
        let every_ms = self.config.reply_every_ms;
        let is_due = |sent_ms| now_ms.wrapping_sub(sent_ms) >= every_ms;
        if !self.replied_ms.is_none_or(is_due) {
            return None;
        }
        self.replied_ms = Some(now_ms);
        let mut reply = Reply::begin(into)?;
        let (drive, overrides) = (self.drive(), self.overrides);
        self.subscriptions
            .due(now_ms, every_ms / 2, |index, value| {
                let value = match value {
                    // An f32: the computer tells an old message by a time that goes back.
                    Value::Time => Some(now_ms as f32 * 1e-3),
                    value => shown(value, readings, &drive, overrides),
                };
                if let Some(value) = value {
                    reply.add(index, value);
                }
            });
        reply.end()
    }

    /// To whom the messages of [`poll`](Self::poll) are sent: the computer that
    /// wrote or requested last; none before the first.
    pub const fn peer(&self) -> Option<P> {
        self.peer
    }

    /// Who has control.
    pub const fn control(&self) -> Control {
        match (self.overrides, self.is_lost) {
            ([false, false], _) => Control::Free,
            (_, false) => Control::Held,
            (_, true) => Control::Failsafe,
        }
    }

    /// What drives the servos now.
    pub fn drive(&self) -> Drive {
        let control = self.control();
        let [joystick, throttles] = self.overrides;
        let [flaps, left, right, gear] = self.wheels;
        let safe = self.config.failsafe;
        let (surfaces, throttle) = if control == Control::Failsafe {
            let surfaces = [safe.elevator, safe.aileron, safe.rudder];
            (Some(surfaces), Some(safe.throttle))
        } else {
            let [elevator, aileron, rudder] = self.yoke;
            let written = elevator
                .zip(aileron)
                .zip(rudder)
                .map(|((elevator, aileron), rudder)| [elevator, aileron, rudder]);
            (written, self.throttle)
        };
        Drive {
            control,
            surfaces: surfaces.filter(|_| joystick),
            throttle: throttle.filter(|_| throttles),
            flaps,
            brakes: left.zip(right).map(|(left, right)| [left, right]),
            gear: gear.map(|gear| {
                if control == Control::Failsafe {
                    1.0
                } else {
                    gear
                }
            }),
        }
    }

    fn notice_loss(&mut self, now_ms: u32) {
        let silent_ms = now_ms.wrapping_sub(self.written_ms);
        if self.control() == Control::Held && silent_ms >= self.config.failsafe_after_ms {
            self.is_lost = true;
        }
    }

    fn value(&self, path: &[u8]) -> Result<Value, NotForBoard> {
        Value::of(path, self.config.engage_switch).ok_or(NotForBoard::NoSuchValue)
    }

    fn write_row(
        &mut self,
        now_ms: u32,
        index: i32,
        columns: [Option<f32>; 8],
    ) -> Result<(), NotForBoard> {
        let targets: &[(usize, Value)] = match index {
            ROW_JOYSTICK => &[
                (0, Value::Elevator),
                (1, Value::Aileron),
                (2, Value::Rudder),
            ],
            ROW_THROTTLES => &[(0, Value::Throttle)],
            ROW_FLAPS => &[(3, Value::Flaps)],
            ROW_BRAKES => &[
                (0, Value::Gear),
                (2, Value::LeftBrake),
                (3, Value::RightBrake),
            ],
            _ => return Err(NotForBoard::NoSuchValue),
        };
        let mut outcome = Ok(());
        for (column, target) in targets {
            if let Some(value) = columns.get(*column).copied().flatten() {
                outcome = outcome.and(self.write(now_ms, *target, value));
            }
        }
        outcome
    }

    fn write(&mut self, now_ms: u32, target: Value, value: f32) -> Result<(), NotForBoard> {
        if !value.is_finite() {
            return Err(NotForBoard::NotFinite);
        }
        let [joystick, throttles] = self.overrides;
        let is_held = match target {
            Value::OverrideJoystick | Value::OverrideThrottles => {
                self.set_override(now_ms, target, value >= 0.5);
                return Ok(());
            }
            Value::Elevator
            | Value::Aileron
            | Value::Rudder
            | Value::Flaps
            | Value::LeftBrake
            | Value::RightBrake
            | Value::Gear => joystick,
            Value::Throttle => throttles,
            Value::Airspeed | Value::DifferentialPressure | Value::EngageSwitch | Value::Time => {
                return Err(NotForBoard::NoSuchValue);
            }
        };
        if !is_held {
            return Err(NotForBoard::NotHeld);
        }
        let [elevator, aileron, rudder] = &mut self.yoke;
        let [flaps, left, right, gear] = &mut self.wheels;
        let (place, least) = match target {
            Value::Elevator => (elevator, -1.0),
            Value::Aileron => (aileron, -1.0),
            Value::Rudder => (rudder, -1.0),
            Value::Flaps => (flaps, 0.0),
            Value::LeftBrake => (left, 0.0),
            Value::RightBrake => (right, 0.0),
            Value::Gear => (gear, 0.0),
            _ => (&mut self.throttle, 0.0),
        };
        *place = Some(value.clamp(least, 1.0));
        self.written_ms = now_ms;
        self.is_lost = false;
        Ok(())
    }

    fn set_override(&mut self, now_ms: u32, which: Value, is_set: bool) {
        if is_set && self.control() == Control::Free {
            // What is written next is awaited from now on.
            self.written_ms = now_ms;
            self.is_lost = false;
        }
        let [joystick, throttles] = &mut self.overrides;
        let of_joystick = which == Value::OverrideJoystick;
        let place = if of_joystick { joystick } else { throttles };
        if *place == is_set {
            return;
        }
        *place = is_set;
        if of_joystick {
            (self.yoke, self.wheels) = ([None; 3], [None; 4]);
        } else {
            self.throttle = None;
        }
    }
}

/// What the computer reads under a name.
fn shown(
    value: Value,
    readings: &Readings,
    drive: &Drive,
    [joystick, throttles]: [bool; 2],
) -> Option<f32> {
    let pilot = readings.pilot.filter(|_| drive.control == Control::Free);
    let of_pilot = |surfaces: Surfaces| [surfaces.elevator, surfaces.aileron, surfaces.rudder];
    let surfaces = drive.surfaces.or(pilot.map(of_pilot));
    let surface = |number: usize| surfaces.and_then(|all| all.get(number).copied());
    match value {
        Value::OverrideJoystick => Some(f32::from(u8::from(joystick))),
        Value::OverrideThrottles => Some(f32::from(u8::from(throttles))),
        Value::Elevator => surface(0),
        Value::Aileron => surface(1),
        Value::Rudder => surface(2),
        Value::Throttle => drive.throttle.or(pilot.map(|pilot| pilot.throttle)),
        Value::Flaps => drive.flaps,
        Value::LeftBrake => drive.brakes.map(|[left, _]| left),
        Value::RightBrake => drive.brakes.map(|[_, right]| right),
        Value::Gear => drive.gear,
        Value::Time => None,
        Value::Airspeed | Value::DifferentialPressure | Value::EngageSwitch => readings.get(value),
    }
}
