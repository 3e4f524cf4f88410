//! The two ways to compare a replay with its recording.

use fcc_core::framework::Record;
use fcc_core::framework::schema::Schema;
use serde::Serialize;

use crate::deviation::Deviation;
use crate::identity::Identity;

/// The two ways to compare a replay with its recording.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// With the recorded configuration: whether every bit is the same.
    Identity(Identity),
    /// With another configuration: how far it deviates.
    Deviation(Deviation),
}

impl Comparison {
    /// Compares one tick as recorded and as replayed.
    pub fn take<M: Schema, E: Schema, S: Schema, O: Schema>(
        &mut self,
        recorded: &Record<M, E, S, O>,
        again: &Record<M, E, S, O>,
    ) {
        match self {
            Self::Identity(identity) => identity.take(recorded, again),
            Self::Deviation(deviation) => deviation.take(recorded, again),
        }
    }

    /// The comparison as text.
    pub fn to_text(&self) -> String {
        match self {
            Self::Identity(identity) => identity.to_text(),
            Self::Deviation(deviation) => format!("\n{}", deviation.to_text()),
        }
    }
}
