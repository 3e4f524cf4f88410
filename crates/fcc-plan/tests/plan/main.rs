//! Plans and their files, from outside.
#![cfg(test)]

mod any_plan;
mod checking;
mod flown;
mod flyable;
mod geometry;
mod qgroundcontrol;
mod reading;
mod refusals;
mod round_trip;
mod terrain;
mod unusual;

use fcc_plan::Place;

const fn place(latitude_deg: f64, longitude_deg: f64) -> Place {
    Place {
        latitude_deg,
        longitude_deg,
    }
}
