//! The states of the loop over time.

use fcc_core::framework::State;
use serde::Serialize;

/// At most this many changes are kept.
const MOST_SPANS: usize = 4_096;

/// A period in one state.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct StateSpan {
    /// Its first tick, s since the recording's first.
    pub from_s: f64,
    /// First tick of the next state, or the last tick.
    pub to_s: f64,
    /// `standby`, `engaged`, `failsafe` or `stopped`.
    pub state: String,
    #[serde(skip)]
    pub(super) phase: Phase,
}

/// A state without its cause.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Phase {
    Standby,
    Engaged,
    Failsafe,
    Stopped,
}

impl From<State> for Phase {
    fn from(state: State) -> Self {
        match state {
            State::Standby => Self::Standby,
            State::Engaged => Self::Engaged,
            State::Failsafe(_) => Self::Failsafe,
            State::Stopped => Self::Stopped,
        }
    }
}

/// Gathers the spans.
#[derive(Clone, Debug, Default)]
pub(super) struct States {
    spans: Vec<StateSpan>,
}

impl States {
    pub(super) fn take(&mut self, time_s: f64, state: State) {
        let full = self.spans.len() >= MOST_SPANS;
        if let Some(last) = self.spans.last_mut() {
            last.to_s = time_s;
            if last.phase == Phase::from(state) || full {
                return;
            }
        }
        self.spans.push(StateSpan {
            from_s: time_s,
            to_s: time_s,
            state: state.to_string(),
            phase: state.into(),
        });
    }

    pub(super) fn into_spans(self) -> Vec<StateSpan> {
        self.spans
    }
}

/// How long the loop was in a phase, s.
pub(super) fn time_in(spans: &[StateSpan], phase: Phase) -> f64 {
    spans
        .iter()
        .filter(|span| span.phase == phase)
        .map(|span| span.to_s - span.from_s)
        .sum()
}
