//! The topics of a recording and their schemas.

/// What says in a file that it is one of ours.
pub(super) const PROFILE: &str = "fcc";

/// How messages and their schemas are encoded.
pub(super) const ENCODING: &str = "protobuf";

/// The topics of a recording.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Topic {
    Record,
    Event,
    Position,
    Attitude,
    Log,
}

macro_rules! descriptors {
    ($name:literal) => {
        include_bytes!(concat!(env!("OUT_DIR"), "/", $name, ".fds"))
    };
}

impl Topic {
    pub(super) const ALL: [Self; 5] = [
        Self::Record,
        Self::Event,
        Self::Position,
        Self::Attitude,
        Self::Log,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Record => "/fcc/record",
            Self::Event => "/fcc/event",
            Self::Position => "/fcc/position",
            Self::Attitude => "/fcc/attitude",
            Self::Log => "/fcc/log",
        }
    }

    /// The full name of the message's type.
    pub(super) const fn schema(self) -> &'static str {
        match self {
            Self::Record => "fcc.v1.Record",
            Self::Event => "fcc.v1.Event",
            Self::Position => "foxglove.LocationFix",
            Self::Attitude => "foxglove.PoseInFrame",
            Self::Log => "foxglove.Log",
        }
    }

    /// The type and all it is made of, as a `FileDescriptorSet`.
    pub(super) const fn descriptors(self) -> &'static [u8] {
        match self {
            Self::Record => descriptors!("record"),
            Self::Event => descriptors!("event"),
            Self::Position => descriptors!("location_fix"),
            Self::Attitude => descriptors!("pose_in_frame"),
            Self::Log => descriptors!("log"),
        }
    }
}
