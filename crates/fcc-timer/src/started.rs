//! Why a thread or a process was not started.

use std::io;

use nix::errno::Errno;
use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};

/// The error of starting a thread or a process; with what to do if a limit of
/// their number or of memory is reached, for which the kernel says only that it is
/// temporarily unavailable (EAGAIN, `clone(2)`, `pthread_create(3)`).
#[must_use]
pub fn not_started(error: io::Error) -> io::Error {
    if error.raw_os_error() != Some(Errno::EAGAIN as i32) {
        return error;
    }
    let of_user = match getrlimit(Resource::RLIMIT_NPROC) {
        Ok((soft, _)) if soft != RLIM_INFINITY => format!("RLIMIT_NPROC is {soft}"),
        _ => "RLIMIT_NPROC is unlimited".to_owned(),
    };
    let of_memory = match getrlimit(Resource::RLIMIT_AS) {
        Ok((soft, _)) if soft != RLIM_INFINITY => format!(
            ". Or the process may have no more memory (RLIMIT_AS is {soft} bytes): raise it with \
             ulimit -v, or LimitAS of the service"
        ),
        _ => String::new(),
    };
    io::Error::new(
        error.kind(),
        format!(
            "{error}: the limit of processes and threads is reached ({of_user} for this user; a \
             service or container has its own): end some, or raise it with ulimit -u, or \
             LimitNPROC and TasksMax of the service{of_memory}"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_that_is_reached_is_named_and_other_errors_stay() {
        let told = |errno: Errno| {
            let error = io::Error::from_raw_os_error(errno as i32);
            not_started(error).to_string()
        };
        let said = told(Errno::EAGAIN);
        for word in ["os error 11", "RLIMIT_NPROC is", "ulimit -u", "TasksMax"] {
            assert!(said.contains(word), "{said}");
        }
        assert_eq!(
            told(Errno::ENOENT),
            io::Error::from_raw_os_error(2).to_string()
        );
    }
}
