//! MAVLink's commands, which both file formats consist of, and what they mean
//! here: the one table in both directions.
//!
//! Numbers, frames and parameters: MAVLink, `common.xml` (`MAV_CMD`,
//! `MAV_FRAME`).

mod decode;
mod encode;
mod fence;

pub(crate) use decode::{ALTITUDE_M, RADIUS_M, Refusal, SPEED_MPS, check, decode, place};
pub(crate) use encode::{canonical, encode};
pub(crate) use fence::{FenceReader, at_most, fence_commands, rally_commands};

/// `MAV_CMD`.
pub(crate) mod id {
    pub(crate) const WAYPOINT: u16 = 16;
    pub(crate) const LOITER_UNLIMITED: u16 = 17;
    pub(crate) const LOITER_TURNS: u16 = 18;
    pub(crate) const LOITER_TIME: u16 = 19;
    pub(crate) const RETURN: u16 = 20;
    pub(crate) const LAND: u16 = 21;
    pub(crate) const TAKEOFF: u16 = 22;
    pub(crate) const LOITER_TO_ALTITUDE: u16 = 31;
    pub(crate) const CONDITION_DELAY: u16 = 112;
    pub(crate) const CONDITION_DISTANCE: u16 = 114;
    pub(crate) const JUMP: u16 = 177;
    pub(crate) const CHANGE_SPEED: u16 = 178;
    pub(crate) const CHANGE_ALTITUDE: u16 = 186;
    pub(crate) const LAND_START: u16 = 189;
    pub(crate) const FENCE_RETURN_POINT: u16 = 5_000;
    pub(crate) const FENCE_POLYGON_INCLUSION: u16 = 5_001;
    pub(crate) const FENCE_POLYGON_EXCLUSION: u16 = 5_002;
    pub(crate) const FENCE_CIRCLE_INCLUSION: u16 = 5_003;
    pub(crate) const FENCE_CIRCLE_EXCLUSION: u16 = 5_004;
    pub(crate) const RALLY_POINT: u16 = 5_100;
    /// Those of a camera and its gimbal: region of interest, digicam and mount, trigger,
    /// mode, zoom and focus, gimbal, pictures, video.
    pub(crate) const CAMERA: [core::ops::RangeInclusive<u16>; 8] = [
        195..=197,
        201..=206,
        214..=214,
        530..=532,
        1_000..=1_001,
        2_000..=2_001,
        2_003..=2_003,
        2_500..=2_501,
    ];
    /// Those of a fence and of rally points.
    pub(crate) const FENCE_AND_RALLY: core::ops::RangeInclusive<u16> =
        FENCE_RETURN_POINT..=RALLY_POINT;
}

/// `MAV_FRAME`: what the last three parameters are.
pub(crate) mod frame {
    pub(crate) const GLOBAL: u8 = 0;
    pub(crate) const MISSION: u8 = 2;
    pub(crate) const RELATIVE: u8 = 3;
    pub(crate) const GLOBAL_INT: u8 = 5;
    pub(crate) const RELATIVE_INT: u8 = 6;
    pub(crate) const TERRAIN: u8 = 10;
    pub(crate) const TERRAIN_INT: u8 = 11;
}

/// A command as a file or a ground station has it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Command {
    /// `MAV_CMD`.
    pub id: u16,
    /// `MAV_FRAME`.
    pub frame: u8,
    /// In the units of MAVLink, places in degrees; NaN where one is left to the vehicle.
    pub parameters: [f64; 7],
}
