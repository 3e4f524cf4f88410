//! From items to commands.

use std::fmt::Write as _;

use super::{Command, fence_commands, frame, id, rally_commands};
use crate::item::{Altitude, AltitudeDatum, Item, Loiter, LoiterEnd, Place, Speed};
use crate::plan::Plan;

/// The command that an item is.
pub(crate) fn encode(item: &Item) -> Command {
    match *item {
        Item::Waypoint {
            place,
            altitude,
            radius_m,
        } => {
            let radius = radius_m.unwrap_or(0.0);
            at(id::WAYPOINT, [0.0, radius, 0.0, 0.0], Some(place), altitude)
        }
        Item::Loiter(loiter) => encode_loiter(&loiter),
        Item::Return => plain(id::RETURN, [0.0; 4]),
        Item::Land {
            place,
            altitude,
            abort_altitude_m,
        } => {
            let abort = abort_altitude_m.unwrap_or(0.0);
            at(id::LAND, [abort, 0.0, 0.0, 0.0], place, altitude)
        }
        Item::Takeoff {
            place,
            altitude,
            pitch_deg,
        } => {
            let pitch = pitch_deg.unwrap_or(0.0);
            at(id::TAKEOFF, [pitch, 0.0, 0.0, 0.0], place, altitude)
        }
        Item::Delay { seconds } => plain(id::CONDITION_DELAY, [seconds, 0.0, 0.0, 0.0]),
        Item::UntilDistance { distance_m } => {
            plain(id::CONDITION_DISTANCE, [distance_m, 0.0, 0.0, 0.0])
        }
        Item::ChangeAltitude { altitude } => {
            let frame = f64::from(frame_of(altitude.above));
            plain(id::CHANGE_ALTITUDE, [altitude.m, frame, 0.0, 0.0])
        }
        Item::ChangeSpeed {
            speed,
            throttle_percent,
        } => {
            let (kind, mps) = match speed {
                Some(Speed::GroundSpeedMps(mps)) => (1.0, mps),
                Some(Speed::AirspeedMps(mps)) => (0.0, mps),
                None => (0.0, -1.0),
            };
            let throttle = throttle_percent.unwrap_or(-1.0);
            plain(id::CHANGE_SPEED, [kind, mps, throttle, 0.0])
        }
        Item::Jump { to, times } => {
            let times = times.map_or(-1.0, f64::from);
            plain(id::JUMP, [to as f64, times, 0.0, 0.0])
        }
        Item::LandStart { place } => {
            let altitude = Altitude {
                m: 0.0,
                above: AltitudeDatum::Home,
            };
            at(id::LAND_START, [0.0; 4], place, altitude)
        }
        Item::Camera {
            command,
            frame,
            parameters,
        } => Command {
            id: command,
            frame,
            parameters: parameters.map(|parameter| parameter.unwrap_or(f64::NAN)),
        },
    }
}

fn encode_loiter(loiter: &Loiter) -> Command {
    let radius = loiter.radius_m.unwrap_or(0.0);
    // The sign of 0 says which way around the usual radius is flown.
    let radius = if loiter.clockwise { radius } else { -radius };
    let heading = f64::from(u8::from(loiter.leave_towards_next));
    let (id, parameters) = match loiter.end {
        LoiterEnd::Never => (id::LOITER_UNLIMITED, [0.0, 0.0, radius, 0.0]),
        LoiterEnd::Turns(turns) => (id::LOITER_TURNS, [turns, heading, radius, 0.0]),
        LoiterEnd::Seconds(seconds) => (id::LOITER_TIME, [seconds, heading, radius, 0.0]),
        LoiterEnd::Altitude => (id::LOITER_TO_ALTITUDE, [heading, radius, 0.0, 0.0]),
    };
    at(id, parameters, loiter.place, loiter.altitude)
}

/// A command without a place.
fn plain(id: u16, [a, b, c, d]: [f64; 4]) -> Command {
    Command {
        id,
        frame: frame::MISSION,
        parameters: [a, b, c, d, 0.0, 0.0, 0.0],
    }
}

/// A command with a place, or "here".
fn at(id: u16, [a, b, c, d]: [f64; 4], place: Option<Place>, altitude: Altitude) -> Command {
    let (latitude, longitude) = place.map_or((0.0, 0.0), |place| {
        (place.latitude_deg, place.longitude_deg)
    });
    Command {
        id,
        frame: frame_of(altitude.above),
        parameters: [a, b, c, d, latitude, longitude, altitude.m],
    }
}

fn frame_of(above: AltitudeDatum) -> u8 {
    match above {
        AltitudeDatum::SeaLevel => frame::GLOBAL,
        AltitudeDatum::Home => frame::RELATIVE,
        AltitudeDatum::Terrain => frame::TERRAIN,
    }
}

/// The content of a plan as text, for its hash: the commands, and what is no
/// command. It does not depend on the file's format, nor may it change: hashes are
/// in recordings.
pub(crate) fn canonical(plan: &Plan) -> String {
    let mut text = String::from("plan 1\n");
    let mut line = |name: &str, numbers: &[f64]| {
        text.push_str(name);
        for number in numbers {
            let _ = write!(text, " {number:?}");
        }
        text.push('\n');
    };
    if let Some(home) = plan.home {
        let place = home.place;
        let numbers = [place.latitude_deg, place.longitude_deg, home.altitude_m];
        line("home", &numbers);
    }
    line("cruise", plan.cruise_mps.as_slice());
    let items = plan.items.iter().map(encode);
    let others = fence_commands(&plan.fence).chain(rally_commands(&plan.rally));
    for Command {
        id,
        frame,
        parameters,
    } in items.chain(others)
    {
        line(&format!("{id} {frame}"), &parameters);
    }
    line("floor", plan.fence.floor_m.as_slice());
    line("ceiling", plan.fence.ceiling_m.as_slice());
    for obstacle in &plan.obstacles {
        let place = obstacle.centre;
        let numbers = [
            place.latitude_deg,
            place.longitude_deg,
            obstacle.radius_m,
            obstacle.top_m,
        ];
        line("obstacle", &numbers);
    }
    text
}
