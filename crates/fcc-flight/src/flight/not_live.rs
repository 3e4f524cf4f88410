//! A flight that nobody can watch: this program was built without live
//! telemetry.

use std::ops::RangeInclusive;

use fcc_core::flight::AutopilotCommand;
use fcc_runtime::CommandSender;
use fcc_telemetry::recording::RecorderStatus;
use fcc_telemetry::{FlightEvent, FlightRecord};
use fcc_timer::RealtimeGranted;

use crate::config::{LoopSection, TelemetrySection};

/// Stands where `live.rs` publishes.
pub(super) struct Live;

#[expect(clippy::unused_self, reason = "the shape is live.rs's")]
impl Live {
    pub(super) const fn off() -> Self {
        Self
    }
    pub(super) fn start(_: &TelemetrySection, _: RangeInclusive<f64>) -> Self {
        Self
    }
    pub(super) const fn describe(&mut self, _: &LoopSection, _: &RealtimeGranted, _: &str) {}
    pub(super) const fn record(&mut self, _: &FlightRecord) {}
    pub(super) const fn event(&mut self, _: &FlightEvent, _: &str) {}
    pub(super) const fn remark(&mut self, _: u64, _: i64, _: &str) {}
    pub(super) const fn recorder(&mut self, _: &RecorderStatus) {}
    pub(super) const fn pass_commands(&mut self, _: &mut CommandSender<AutopilotCommand>) {}
    pub(super) const fn poll(&mut self) -> Option<String> {
        None
    }
}
