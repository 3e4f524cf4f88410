//! What is recorded of a multicopter, and its commands.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use fcc_core::schema;

schema! {
    /// What is flown.
    pub enum Mode {
        /// On the ground, motors off.
        Idle = 0,
        /// Rise to a height.
        TakeOff = 1,
        /// Hold a place.
        Hover = 2,
        /// Fly to a place, and hold it.
        GoTo = 3,
        /// Fly to a waypoint of the plan.
        Plan = 4,
        /// Circle.
        Circle = 5,
        /// Fly home, and land there.
        Return = 6,
        /// Land where it is.
        Land = 7,
        /// Descend without a position.
        Descend = 8,
        /// Follow a stick.
        Stick = 9,
    }
}

schema! {
    /// What the landing detector sees; its last stage stops the motors.
    pub enum GroundContact {
        /// It flies.
        Flying = 0,
        /// It does not sink any more.
        Touching = 1,
        /// It stands still with little thrust.
        Standing = 2,
        /// It has landed.
        Landed = 3,
    }
}

schema! {
    /// The estimate, metres and radians.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Estimate {
        /// North of home.
        #[field(1)]
        pub north_m: f64,
        /// East of home.
        #[field(2)]
        pub east_m: f64,
        /// Above home.
        #[field(3)]
        pub height_m: f64,
        /// Towards north.
        #[field(4)]
        pub north_mps: f64,
        /// Towards east.
        #[field(5)]
        pub east_mps: f64,
        /// Upwards.
        #[field(6)]
        pub climb_mps: f64,
        /// Right side down.
        #[field(7, range = -PI..=PI)]
        pub roll_rad: f64,
        /// Nose up.
        #[field(8, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub pitch_rad: f64,
        /// Clockwise from true north.
        #[field(9, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// The share of full thrust that hovering takes.
        #[field(10, range = 0.0..=1.0)]
        pub hover_thrust: f64,
        /// What the landing detector sees.
        #[field(11)]
        pub ground: GroundContact,
        /// What the rotors could not give.
        #[field(12, column = "missing_*")]
        pub missing: Shortfall,
    }
}

schema! {
    /// What was demanded of the rotors and could not be allocated.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Shortfall {
        /// Specific thrust.
        #[field(1)]
        pub thrust_mps2: f64,
        /// About x.
        #[field(2)]
        pub roll_radps2: f64,
        /// About y.
        #[field(3)]
        pub pitch_radps2: f64,
        /// About z.
        #[field(4)]
        pub yaw_radps2: f64,
    }
}

schema! {
    /// The set points, metres and radians.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Setpoints {
        /// North of home.
        #[field(1)]
        pub north_m: f64,
        /// East of home.
        #[field(2)]
        pub east_m: f64,
        /// Above home.
        #[field(3)]
        pub height_m: f64,
        /// Towards north.
        #[field(4)]
        pub north_mps: f64,
        /// Towards east.
        #[field(5)]
        pub east_mps: f64,
        /// Upwards.
        #[field(6)]
        pub climb_mps: f64,
        /// Right side down.
        #[field(7, range = -PI..=PI)]
        pub roll_rad: f64,
        /// Nose up.
        #[field(8, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub pitch_rad: f64,
        /// Clockwise from true north.
        #[field(9, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// What is flown.
        #[field(10)]
        pub mode: Mode,
        /// The item of the plan, from 1; 0 without one.
        #[field(11)]
        pub item: u16,
    }
}

schema! {
    /// A place to fly to, from home.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct GoTo {
        /// North of home.
        #[field(1)]
        pub north_m: f64,
        /// East of home.
        #[field(2)]
        pub east_m: f64,
        /// Above home.
        #[field(3)]
        pub height_m: f64,
        /// Clockwise from true north; none: as it is.
        #[field(4)]
        pub heading_rad: Option<f64>,
    }
}

schema! {
    /// A stick that demands velocities. Not given again for 2 s it is let go: it hovers.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Velocity {
        /// Along the nose.
        #[field(1)]
        pub forward_mps: f64,
        /// To its right.
        #[field(2)]
        pub right_mps: f64,
        /// Upwards.
        #[field(3)]
        pub climb_mps: f64,
        /// Clockwise from above.
        #[field(4)]
        pub yaw_radps: f64,
    }
}

schema! {
    /// A stick that tilts: it speeds up by g tan of the tilt, less as it gets faster. Not given
    /// again for 2 s it is let go: it hovers.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Tilt {
        /// Right side down.
        #[field(1, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub roll_rad: f64,
        /// Nose up.
        #[field(2, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub pitch_rad: f64,
        /// Upwards.
        #[field(3)]
        pub climb_mps: f64,
        /// Clockwise from above.
        #[field(4)]
        pub yaw_radps: f64,
    }
}

schema! {
    /// A command to a multicopter. One that is not possible now is ignored: all but the take-off
    /// and the plan on the ground, the take-off in the air.
    #[derive(Clone, Copy, PartialEq, Debug)]
    #[name("MulticopterCommand")]
    #[non_exhaustive]
    pub enum Command {
        /// Stop, and hold the place.
        #[field(1)]
        Hover,
        /// Rise to a height above home, m, at least 1.
        #[field(2)]
        TakeOff(height_m: f64),
        /// Fly to a place, and hold it.
        #[field(3)]
        GoTo(go_to: GoTo),
        /// Fly the plan from this item on, from 1.
        #[field(4)]
        Plan(plan_item: u16),
        /// Circle around the place that is this far to the right, m; to the left if negative.
        #[field(5)]
        Circle(radius_m: f64),
        /// Fly home, and land there.
        #[field(6)]
        Return,
        /// Land where it is.
        #[field(7)]
        Land,
        /// Follow a stick that demands velocities.
        #[field(8)]
        Move(velocity: Velocity),
        /// Follow a stick that tilts.
        #[field(9)]
        Tilt(tilt: Tilt),
        /// Stop the motors at once, also in the air.
        #[field(10)]
        StopMotors,
    }
}
