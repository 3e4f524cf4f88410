//! The true state of the simulated aircraft, without sensor errors.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use fcc_core::flight::{BodyRates, SpecificForce, Velocity};
use fcc_core::framework::schema::{Field, Schema, Sink, Source, Value};
use fcc_core::schema;

schema! {
    /// The true state at one moment.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Truth {
        /// Simulated time, s.
        #[field(1)]
        pub time_s: f64,
        /// Right wing down, rad.
        #[field(2, range = -PI..=PI)]
        pub roll_rad: f64,
        /// Nose up, rad.
        #[field(3, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub pitch_rad: f64,
        /// True heading, rad.
        #[field(4, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// Turn rates.
        #[field(5)]
        pub rates: BodyRates,
        /// Specific force at the centre of gravity.
        #[field(6, column = "specific_force_*")]
        pub specific_force: SpecificForce,
        /// True airspeed, m/s.
        #[field(7)]
        pub true_airspeed_mps: f64,
        /// Indicated airspeed, m/s.
        #[field(8)]
        pub indicated_airspeed_mps: f64,
        /// Angle of attack, rad.
        #[field(9)]
        pub angle_of_attack_rad: f64,
        /// Sideslip, rad, positive when the air comes from the right.
        #[field(10)]
        pub sideslip_rad: f64,
        /// North of where the flight began, m.
        #[field(11)]
        pub north_m: f64,
        /// East of where the flight began, m.
        #[field(12)]
        pub east_m: f64,
        /// Above mean sea level, m.
        #[field(13)]
        pub altitude_m: f64,
        /// Over the ground.
        #[field(14)]
        pub velocity: Velocity,
        /// Throttle after the engine's lag.
        #[field(15, range = 0.0..=1.0)]
        pub throttle: f64,
        /// Elevator deflection, rad, positive trailing edge down.
        #[field(16)]
        pub elevator_rad: f64,
        /// Aileron deflection, rad, positive rolls right.
        #[field(17)]
        pub aileron_rad: f64,
        /// Rudder deflection, rad, positive trailing edge left.
        #[field(18)]
        pub rudder_rad: f64,
    }
}

/// What knows the truth of a simulated vehicle.
pub trait HasTruth {
    /// The truth after the last step.
    fn truth(&self) -> Truth;
}

/// Numbers in a [`Truth`].
pub(crate) const NUMBERS: usize = Truth::TYPE.leaves();

/// The numbers of a truth, in the order of its fields.
struct Numbers {
    numbers: [f64; NUMBERS],
    next: usize,
}

impl Sink for Numbers {
    fn value(&mut self, _: &'static Field, value: Value) {
        if let (Some(place), Value::Number(number)) = (self.numbers.get_mut(self.next), value) {
            *place = number;
        }
        self.next += 1;
    }
}

impl Source for Numbers {
    fn value(&mut self, _: &'static Field) -> Option<Value> {
        self.next += 1;
        let number = self.numbers.get(self.next - 1).copied();
        number.map(Value::Number)
    }
}

impl Truth {
    /// Every number, in the order of the fields.
    pub(crate) fn to_array(self) -> [f64; NUMBERS] {
        let mut found = Numbers {
            numbers: [0.0; NUMBERS],
            next: 0,
        };
        self.visit(&mut found);
        found.numbers
    }

    /// The inverse of [`to_array`](Self::to_array).
    pub(crate) fn from_array(numbers: [f64; NUMBERS]) -> Self {
        let mut numbers = Numbers { numbers, next: 0 };
        // Every number is a value that its field can have.
        Self::from_source(&mut numbers).unwrap_or_default()
    }

    /// Interpolates between this and a later truth, with `share` in 0..=1;
    /// angles take the shorter way round.
    #[must_use]
    pub fn towards(&self, later: &Self, share: f64) -> Self {
        let (here, there) = (self.to_array(), later.to_array());
        let mut between = here;
        for (number, there) in between.iter_mut().zip(there) {
            *number += share * (there - *number);
        }
        Self {
            roll_rad: angle_between(self.roll_rad, later.roll_rad, share),
            heading_rad: turn(angle_between(self.heading_rad, later.heading_rad, share)),
            ..Self::from_array(between)
        }
    }
}

fn angle_between(from: f64, to: f64, share: f64) -> f64 {
    from + share * half_turn(to - from)
}

/// The angle in -π..=π.
pub(crate) fn half_turn(angle_rad: f64) -> f64 {
    libm::remainder(angle_rad, TAU)
}

/// The angle in 0..2π.
pub(crate) fn turn(angle_rad: f64) -> f64 {
    let around = half_turn(angle_rad);
    if around < 0.0 {
        // A tiny negative angle would round up to a full turn.
        let positive = around + TAU;
        if positive < TAU { positive } else { 0.0 }
    } else {
        around
    }
}
