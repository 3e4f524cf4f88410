//! Exit codes.

use std::process::ExitCode;

use fcc_flight::flight::Conclusion;

/// Declares the exit codes, and the text about them for `--help`.
macro_rules! exits {
    ($($name:ident = $code:literal, $text:literal;)*) => {
        /// How the program ends.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        #[repr(u8)]
        pub enum Exit {
            $(#[doc = $text] $name = $code,)*
        }

        /// The exit codes, for `--help`.
        pub fn exit_codes() -> String {
            let codes = [$(format!("{:3}  {}", $code, $text)),*];
            format!("Exit codes:\n{}", codes.join("\n"))
        }
    };
}

exits! {
    Success = 0, "success";
    Failure = 1, "the operating system, the network or a part of the program failed";
    Usage = 2, "the command line, or a configuration, plan, recording or folder is wrong";
    Failsafe = 3, "the flight entered failsafe";
    RealtimeDenied = 4, "a real-time request was denied and realtime.strict is set";
    NotReleased = 5, "the controls may not have been released";
    Panicked = 6, "a part of the loop panicked; the controls were released";
    Differs = 7, "a replay gave other outputs";
    NotReplayed = 8, "a recording, or its end, could not be replayed; what could does not differ";
    Hung = 9, "the loop hung; the watchdog released the controls and ended it";
    MachineLacks = 10, "the machine lacks something that a real-time loop needs (doctor)";
    Refused = 11, "the daemon refused the command";
    Taken = 12, "another program uses the simulator or the local port";
    Incomplete = 13, "a recording is damaged or unfinished: the result is of the rest";
    NotRecorded = 14, "the flight succeeded, but was not recorded completely";
    StepFailed = 15, "a step failed or was skipped (x-plane check)";
    HitGround = 16, "the built-in aircraft hit the ground";
    Overloaded = 17, "ticks left no time to sleep; the loop released the controls and stopped";
    CalibrationRefused = 18, "a calibration would be poor, and was refused (calibrate)";
    NotFlown = 19, "the plan was not flown to its end, or engaging was refused";
    ControlsNotChecked = 20, "a control is reversed, without effect or not confirmed (check-controls)";
}

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
            Conclusion::NotFlown => Self::NotFlown,
            Conclusion::Failsafe => Self::Failsafe,
            Conclusion::HitGround => Self::HitGround,
            Conclusion::Panicked => Self::Panicked,
            Conclusion::Hung => Self::Hung,
            Conclusion::Overloaded => Self::Overloaded,
            Conclusion::NotReleased => Self::NotReleased,
        }
    }
}
