//! Why a take-off or a landing is given up.

use core::fmt;

use fcc_core::schema;

schema! {
    /// Why a take-off or a landing is given up, or what else there is to tell of the ground.
    pub enum RunwayReason {
        /// It is not given up.
        None = 0,
        /// A command.
        Commanded = 1,
        /// Too far off the centre line.
        CentreLine = 2,
        /// Too far off the glide path.
        GlidePath = 3,
        /// The airspeed is not that of the approach.
        Airspeed = 4,
        /// Too much bank.
        Bank = 5,
        /// The range finder shows ground where the glide path leads.
        Ground = 6,
        /// It has flared, and is not down.
        LongFlare = 7,
        /// The speed for lift-off is not reached within its way, or the time of it.
        LongRoll = 8,
        /// The aircraft does not stand in the direction of the runway.
        Alignment = 9,
        /// The altimeter does not show the elevation on which it stands.
        Altimeter = 10,
        /// The range finder does not show the height of its wheels.
        RangeFinder = 11,
        /// A failsafe, or a loss, on the wheels.
        Failsafe = 13,
        /// Altimeter and satellite receiver do not agree.
        Receiver = 14,
        /// It was given up too often.
        NoMore = 15,
        /// The wheels touch the ground, and neither a take-off nor a landing is flown.
        Touched = 16,
        /// The airspeed is less than the wheels tell.
        NoAirspeed = 17,
        /// The range finder shows other ground than before, and the altitude does not.
        RangeJump = 18,
        /// The engine is out before the wheels have left the ground.
        Engine = 19,
        /// A climb lasts too long, and is too low to turn.
        NoClimb = 20,
        /// The nose is raised, and the wheels stay on the ground.
        NoLiftOff = 21,
        /// A landing with more than 10 kt of tail wind.
        TailWind = 22,
        /// The roll-out leaves the centre line with its brakes set.
        Strays = 23,
        /// No position was measured for longer than configured.
        NoPosition = 24,
    }
}

impl fmt::Display for RunwayReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "",
            Self::Commanded => "going around: commanded",
            Self::CentreLine => "given up: too far off the centre line of the runway",
            Self::GlidePath => "going around: too far off the glide path",
            Self::Airspeed => "going around: the airspeed is not that of the approach",
            Self::Bank => "going around: too much bank",
            Self::Ground => "going around: the range finder shows ground near the glide path",
            Self::LongFlare => "going around: flared, and not down",
            Self::LongRoll => {
                "the take-off is given up: rotate_kt is not reached within longest_roll_m or the \
                 time of such a roll; look at the engine, the brakes and the load"
            }
            Self::Alignment => {
                "no take-off: the heading is not that of the runway; turn the aircraft, or mend \
                 the mounting of the sensors or the plan"
            }
            Self::Altimeter => {
                "no take-off: the altimeter does not show the elevation of the plan's home; set \
                 it, or mend the plan"
            }
            Self::RangeFinder => {
                "the range finder does not show height_on_wheels_m on the wheels: it is not used"
            }
            Self::Receiver => {
                "going around: the altimeter is more than 20 m off the satellite receiver's \
                 altitude; set the altimeter"
            }
            Self::NoMore => {
                "the landing was given up three times: circling over the runway; command an \
                 item of the plan, the landing for three more"
            }
            Self::NoAirspeed => {
                "the take-off is given up: the airspeed stays more than 15 kt below the speed over \
                 the ground; look at the pitot tube, its cover, and the wind"
            }
            Self::RangeJump => {
                "going around: the range finder and the altitude have ceased to agree; the \
                 range finder is not used any more: land by the altimeter, set it"
            }
            Self::Engine => {
                "the take-off is given up: the engine is out; start it, or set \
                 engine_out_below_rpm below the speed at which it idles"
            }
            Self::NoClimb => {
                "the climb has not reached its altitude in two minutes: there is not enough power \
                 for it; take over, and land ahead"
            }
            Self::NoLiftOff => {
                "the take-off is given up: the wheels stay on the ground for 10 s at rotate_kt; \
                 look at the engine, the load and rotate_kt"
            }
            Self::TailWind => {
                "the landing needs over 50 % more runway; go around, and land the other way"
            }
            Self::Strays => {
                "the roll-out leaves the centre line: brakes released, and half of them from \
                 now on; look at brakes and nose wheel"
            }
            Self::NoPosition => "given up: no position for longer than position_lost_after_s",
            Self::Failsafe => "the take-off is given up",
            Self::Touched => {
                "the wheels touch the ground outside of a take-off or a landing: climb, or take \
                 over"
            }
        })
    }
}
