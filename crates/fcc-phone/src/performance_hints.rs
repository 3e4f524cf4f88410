//! Performance hints (NDK: `android/performance_hint.h`, Android 13): the system is told
//! how long the work of a thread may take and how long it took, and lets its CPU run as
//! fast as that needs.
//!
//! A thread that works for some microseconds of each period and sleeps between them
//! looks idle: without hints a phone may run it on its slowest CPU at its lowest
//! frequency.
#![allow(unsafe_code, reason = "Android's interface is C's")]

use core::ffi::{c_int, c_void};
use core::time::Duration;
use std::io;
use std::sync::OnceLock;
use std::time::Instant;

use libloading::Library;

use crate::library::LIBRARY;

/// `APerformanceHintManager`.
type Manager = *mut c_void;
/// `APerformanceHintSession`.
type Session = *mut c_void;

/// The functions, looked up in phones, too: those that the app is made for may be older.
struct Functions {
    get_manager: unsafe extern "C" fn() -> Manager,
    get_preferred_rate_ns: unsafe extern "C" fn(Manager) -> i64,
    create_session: unsafe extern "C" fn(Manager, *const i32, usize, i64) -> Session,
    report: unsafe extern "C" fn(Session, i64) -> c_int,
    close: unsafe extern "C" fn(Session),
    /// Not unloaded while its functions are here.
    _library: Library,
}

impl Functions {
    fn find(library: &str) -> Result<Self, libloading::Error> {
        // SAFETY: its initialisers are those of Android, whose library is loaded already,
        // or of a library of this project.
        let library = unsafe { Library::new(library) }?;
        // SAFETY: declared as in the NDK.
        unsafe {
            Ok(Self {
                get_manager: *library.get(b"APerformanceHint_getManager\0")?,
                get_preferred_rate_ns: *library
                    .get(b"APerformanceHint_getPreferredUpdateRateNanos\0")?,
                create_session: *library.get(b"APerformanceHint_createSession\0")?,
                report: *library.get(b"APerformanceHint_reportActualWorkDuration\0")?,
                close: *library.get(b"APerformanceHint_closeSession\0")?,
                _library: library,
            })
        }
    }

    /// The functions, looked up once.
    fn found() -> Result<&'static Self, NoHintSession> {
        static FOUND: OnceLock<Option<Functions>> = OnceLock::new();
        let found = FOUND.get_or_init(|| Self::find(LIBRARY).ok());
        found.as_ref().ok_or(NoHintSession::NotOffered)
    }
}

/// Why there is no session of performance hints.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum NoHintSession {
    /// The system does not have the functions.
    #[error("not offered by this system, only by Android 13 and newer")]
    NotOffered,
    /// The system has the functions, and the phone does nothing by them.
    #[error("not offered by this phone")]
    NotSupported,
    /// No session was created.
    #[error("Android refused a session for the thread {0}")]
    Refused(i32),
    /// A report was refused, and the session is closed.
    #[error("Android refused a report: {0}")]
    ReportRefused(String),
}

/// A session of performance hints for one thread, closed when it is dropped.
///
/// For the thread that begins it, which must not be the one that it is for: each report
/// is a message to another process. Reports are made no oftener than the phone prefers,
/// and what it is told is the longest work since the last one: the work that was late
/// counts, not the mean.
pub struct HintSession {
    functions: &'static Functions,
    session: Session,
    report_every: Duration,
    reported: Option<Instant>,
    /// Of the work since the last report; 0 of none.
    longest: Duration,
}

impl HintSession {
    /// Begins a session for a thread of this process, as the kernel numbers it, whose
    /// work should take no longer than this; more than 0.
    ///
    /// # Errors
    /// When the system or the phone has no performance hints, or refuses.
    pub fn begin(thread: i32, target: Duration) -> Result<Self, NoHintSession> {
        let functions = Functions::found()?;
        // SAFETY: it takes nothing.
        let manager = unsafe { (functions.get_manager)() };
        if manager.is_null() {
            return Err(NoHintSession::NotSupported);
        }
        // SAFETY: the manager is one.
        let every_ns = unsafe { (functions.get_preferred_rate_ns)(manager) };
        // Negative of a phone that does nothing by them.
        let report_every = match u64::try_from(every_ns) {
            Ok(every_ns @ 1..) => Duration::from_nanos(every_ns),
            _ => return Err(NoHintSession::NotSupported),
        };
        let target_ns = nanoseconds(target);
        // SAFETY: the manager is one, and there is one thread.
        let session =
            unsafe { (functions.create_session)(manager, &raw const thread, 1, target_ns) };
        if session.is_null() {
            return Err(NoHintSession::Refused(thread));
        }
        Ok(Self {
            functions,
            session,
            report_every,
            reported: None,
            longest: Duration::ZERO,
        })
    }

    /// The thread has worked for so long.
    pub fn worked(&mut self, took: Duration) {
        self.longest = self.longest.max(took);
    }

    /// Reports the longest work since the last report, if there was any, and if the phone
    /// wants to know already; whether it did.
    ///
    /// # Errors
    /// When the phone refuses: the session is of no use any more.
    pub fn report(&mut self) -> Result<bool, NoHintSession> {
        let is_early = |reported: Instant| reported.elapsed() < self.report_every;
        if self.longest.is_zero() || self.reported.is_some_and(is_early) {
            return Ok(false);
        }
        let took_ns = nanoseconds(self.longest);
        // SAFETY: the session is one, and of this thread.
        let error = unsafe { (self.functions.report)(self.session, took_ns) };
        if error != 0 {
            let error = io::Error::from_raw_os_error(error);
            return Err(NoHintSession::ReportRefused(error.to_string()));
        }
        self.longest = Duration::ZERO;
        self.reported = Some(Instant::now());
        Ok(true)
    }
}

impl Drop for HintSession {
    fn drop(&mut self) {
        // SAFETY: the session is one, and not used any more.
        unsafe { (self.functions.close)(self.session) }
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The C library has none of the functions, as `libandroid.so` before Android 13.
    #[test]
    fn a_library_without_the_functions_offers_none() {
        assert!(Functions::find("libc.so.6").is_err());
        assert!(Functions::find("libnothing-has-this-name.so").is_err());
    }
}
