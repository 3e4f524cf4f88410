//! Exit codes.

use std::process::ExitCode;

use fcc_flight::flight::Conclusion;

/// How the program ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Exit {
    /// Success.
    Success = 0,
    /// The operating system, the network or a part of the program failed.
    Failure = 1,
    /// The command line or the configuration is wrong, or a recording is of
    /// another plant.
    Usage = 2,
    /// The flight was in failsafe.
    Failsafe = 3,
    /// A real-time request was denied and `realtime.strict` is set.
    RealtimeDenied = 4,
    /// The controls may not have been released.
    NotReleased = 5,
    /// A part of the loop panicked; the controls were released.
    Panicked = 6,
    /// A replay gave other outputs.
    Differs = 7,
    /// A recording could not be replayed to its end; the rest does not
    /// differ.
    NotReplayed = 8,
    /// The loop hung; its watchdog released the controls and ended the program.
    Hung = 9,
    /// The machine lacks something that a real-time loop needs.
    MachineLacks = 10,
    /// The daemon refused a command.
    Refused = 11,
    /// Another program uses the simulator or the local port.
    Taken = 12,
    /// A recording is damaged or unfinished: the result is of the rest.
    Incomplete = 13,
    /// The flight succeeded, but was not recorded completely.
    NotRecorded = 14,
    /// A step of the check against X-Plane failed or was skipped.
    StepFailed = 15,
}

/// For `--help`.
pub const EXIT_CODES: &str = "\
Exit codes:
  0  success
  1  the operating system, the network or a part of the program failed
  2  the command line or the configuration is wrong, or a recording is of
     another plant
  3  the flight entered failsafe
  4  a real-time request was denied and realtime.strict is set
  5  the controls may not have been released
  6  a part of the loop panicked; the controls were released
  7  a replay gave other outputs
  8  a recording could not be replayed to its end; the rest does not differ
  9  the loop hung; the watchdog released the controls and ended the program
 10  the machine lacks something that a real-time loop needs (doctor)
 11  the daemon refused the command
 12  another program uses the simulator or the local port
 13  a recording is damaged or unfinished: the result is of the rest (report,
     replay), or a part of it is lost (list, recover)
 14  the flight succeeded, but was not recorded completely
 15  a step of the check against X-Plane failed or was skipped (x-plane check)";

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

impl From<Conclusion> for Exit {
    fn from(conclusion: Conclusion) -> Self {
        match conclusion {
            Conclusion::Completed => Self::Success,
            Conclusion::NotRecorded => Self::NotRecorded,
            Conclusion::Failed => Self::Failure,
            Conclusion::Failsafe => Self::Failsafe,
            Conclusion::Panicked => Self::Panicked,
            Conclusion::Hung => Self::Hung,
            Conclusion::NotReleased => Self::NotReleased,
        }
    }
}
