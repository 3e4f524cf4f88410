//! `[x-plane]`: the aircraft is X-Plane's.

use std::time::Duration;

use fcc_xplane::{AxialLoad, DataRows, Input, Output, RowsVersion, Simulator, XPlaneConfig};
use serde::{Deserialize, Serialize};

/// `[x-plane]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct XPlaneSection {
    /// `beacon`, or an address or host name, with a port if it is not 49000.
    #[serde(with = "super::as_text")]
    pub simulator: Simulator,
    /// UDP port to receive on; 0 for 49071, or another that is free.
    pub local_port: u16,
    /// The port from which X-Plane is expected to answer; 0 if it is not known.
    pub reply_port: u16,
    /// How measurements are received.
    pub input: InputChoice,
    /// The version that sends the rows, for `input = "data"`.
    pub data_version: u8,
    /// Column of the magnetic heading in the attitude row, for
    /// `input = "data"`.
    pub magnetic_heading_column: u8,
    /// What a positive axial load in row 4 means, for `input = "data"`.
    pub axial_load: AxialLoadChoice,
    /// How control surfaces are written.
    pub output: OutputChoice,
    /// The rate at which each dataref is requested.
    pub rate_hz: u16,
    /// The number of engines whose throttle is written.
    pub engines: u8,
    /// The dataref of the engage switch: on from 0.75 upwards, off below 0.25,
    /// unchanged in between.
    pub engage_switch: String,
    /// A dataref without a value for this long is requested again.
    pub resubscribe_s: f64,
    /// The simulator counts as silent after this long without a datagram.
    pub silent_after_ms: u64,
    /// The most datagrams read in one tick; the rest are discarded.
    pub datagrams_per_tick: u16,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
}

/// How measurements are received.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputChoice {
    /// As subscribed datarefs.
    Rref,
    /// As rows of Data Output.
    Data,
}

/// What a positive axial load in row 4 of Data Output means.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxialLoadChoice {
    /// Found out in flight.
    Auto,
    /// A load forwards.
    Forwards,
    /// A load backwards.
    Backwards,
}

/// How control surfaces are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputChoice {
    /// As datarefs.
    Dref,
    /// As rows.
    Data,
}

impl Default for XPlaneSection {
    fn default() -> Self {
        let core = XPlaneConfig::default();
        Self {
            simulator: core.simulator,
            local_port: core.local_port,
            reply_port: core.reply_port,
            input: InputChoice::Rref,
            data_version: 12,
            magnetic_heading_column: 3,
            axial_load: AxialLoadChoice::Auto,
            output: OutputChoice::Dref,
            rate_hz: core.rate_hz,
            engines: core.engines,
            engage_switch: core.engage_switch,
            resubscribe_s: core.resubscribe.as_secs_f64(),
            silent_after_ms: core.silent_after.as_millis() as u64,
            datagrams_per_tick: core.datagrams_per_tick,
            fallback_after_ms: core.fallback_after.as_millis() as u64,
        }
    }
}

impl From<&XPlaneSection> for XPlaneConfig {
    fn from(section: &XPlaneSection) -> Self {
        Self {
            simulator: section.simulator.clone(),
            local_port: section.local_port,
            reply_port: section.reply_port,
            input: match section.input {
                InputChoice::Rref => Input::Rref,
                InputChoice::Data => Input::Data(DataRows {
                    version: match section.data_version {
                        9 => RowsVersion::XPlane9,
                        10 | 11 => RowsVersion::XPlane10,
                        _ => RowsVersion::XPlane12,
                    },
                    magnetic_heading_column: section.magnetic_heading_column,
                    axial_load: match section.axial_load {
                        AxialLoadChoice::Auto => AxialLoad::Auto,
                        AxialLoadChoice::Forwards => AxialLoad::Forwards,
                        AxialLoadChoice::Backwards => AxialLoad::Backwards,
                    },
                }),
            },
            output: match section.output {
                OutputChoice::Dref => Output::Dref,
                OutputChoice::Data => Output::Data,
            },
            rate_hz: section.rate_hz,
            engines: section.engines,
            engage_switch: section.engage_switch.clone(),
            // One that is out of its range is reported; here it must not panic.
            resubscribe: Duration::try_from_secs_f64(section.resubscribe_s).unwrap_or_default(),
            silent_after: Duration::from_millis(section.silent_after_ms),
            datagrams_per_tick: section.datagrams_per_tick,
            fallback_after: Duration::from_millis(section.fallback_after_ms),
            ..Self::default()
        }
    }
}
