//! The values that are written for surfaces, throttles and trim.
//!
//! The signs are those used throughout: X-Plane's `yoke_pitch_ratio` is
//! positive nose up, `yoke_roll_ratio` positive right, `yoke_heading_ratio`
//! positive nose right, each -1..1, and so are the columns of row 8; throttles
//! are 0..1. So are flaps and brakes; the nose wheel follows `yoke_heading_ratio`. The
//! gear's handle is up or down, 0 or 1.

use core::iter;

use fcc_core::flight::Surfaces;

use crate::protocol::data::Row;

/// Rows of Data Output.
const ROW_JOYSTICK: i32 = 8;
const ROW_THROTTLES: i32 = 25;
/// Those of flaps, gear and brakes: flaps are column 3, the gear 0, brakes 2 and 3.
const ROW_FLAPS: i32 = 13;
const ROW_BRAKES: i32 = 14;

/// The values to write; `None` leaves a control unchanged.
#[derive(Clone, Copy)]
pub(crate) struct Deflections {
    /// Elevator, aileron, rudder.
    pub(crate) yoke: [Option<f32>; 3],
    pub(crate) throttle: Option<f32>,
    /// What is written only when it is given, in the order of
    /// [`OCCASIONAL`](crate::controls::OCCASIONAL).
    pub(crate) occasional: [Option<f32>; 6],
}

impl Deflections {
    pub(crate) const CENTRED: Self = Self {
        yoke: [Some(0.0); 3],
        throttle: None,
        occasional: [None; 6],
    };
    pub(crate) const AS_THEY_ARE: Self = Self {
        yoke: [None; 3],
        throttle: None,
        occasional: [None; 6],
    };

    /// Limited to their ranges; NaN leaves a control unchanged. The loop has
    /// already checked its outputs; this is the last check before the aircraft.
    pub(crate) fn of(surfaces: &Surfaces) -> Self {
        let brake = |brake: Option<f64>| brake.and_then(|brake| ratio(brake, 0.0));
        let brakes = [surfaces.left_brake, surfaces.right_brake].map(brake);
        let [left, right] = brakes;
        let overrides = brakes.iter().any(Option::is_some).then_some(1.0);
        let trim = surfaces.elevator_trim.and_then(|trim| ratio(trim, -1.0));
        let flaps = surfaces.flaps.and_then(|flaps| ratio(flaps, 0.0));
        let gear = surfaces.gear.filter(|gear| !gear.is_nan());
        let gear = gear.map(|gear| if gear < 0.5 { 0.0 } else { 1.0 });
        Self {
            yoke: yoke_ratios(surfaces),
            throttle: ratio(surfaces.throttle, 0.0),
            occasional: [trim, flaps, overrides, left, right, gear],
        }
    }

    /// As rows: joystick and throttles, then those of flaps, brakes and gear, which a
    /// servo board has.
    pub(crate) fn rows(&self, engines: usize) -> [Row; 4] {
        let [elevator, aileron, rudder] = self.yoke;
        let [_, flaps, _, left, right, gear] = self.occasional;
        let none = None;
        [
            (
                ROW_JOYSTICK,
                [elevator, aileron, rudder, none, none, none, none, none],
            ),
            (
                ROW_THROTTLES,
                core::array::from_fn(|engine| self.throttle.filter(|_| engine < engines)),
            ),
            (ROW_FLAPS, [none, none, none, flaps, none, none, none, none]),
            (
                ROW_BRAKES,
                [gear, none, left, right, none, none, none, none],
            ),
        ]
        .map(|(index, columns)| Row { index, columns })
    }

    /// Whether there are flaps, brakes or gear.
    pub(crate) fn moves_wheels(&self) -> bool {
        let [_, flaps, _, left, right, gear] = self.occasional;
        flaps.or(left).or(right).or(gear).is_some()
    }

    /// Elevator, aileron, rudder, the throttle of every engine, then what is
    /// occasional, in as many writes.
    pub(crate) fn values(&self, writes: usize) -> impl Iterator<Item = Option<f32>> {
        let engines = writes.saturating_sub(self.yoke.len() + self.occasional.len());
        let throttles = iter::repeat_n(self.throttle, engines);
        self.yoke
            .into_iter()
            .chain(throttles)
            .chain(self.occasional)
    }
}

fn ratio(value: f64, least: f64) -> Option<f32> {
    (!value.is_nan()).then(|| value.clamp(least, 1.0) as f32)
}

/// What is written to the yoke for these surfaces: elevator, aileron, rudder.
pub(crate) fn yoke_ratios(surfaces: &Surfaces) -> [Option<f32>; 3] {
    [surfaces.elevator, surfaces.aileron, surfaces.rudder].map(|value| ratio(value, -1.0))
}
