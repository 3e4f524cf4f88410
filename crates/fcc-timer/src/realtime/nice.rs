//! The nice value of a thread: its share of the CPU under the ordinary
//! scheduler.
//!
//! The system calls are made directly: the kernel's nice value is a thread's, and
//! its `getpriority` answers 20 - nice, so that no value looks like an error
//! (getpriority(2)).
#![allow(unsafe_code)]

use nix::errno::Errno;

use super::DeniedRequest;

/// What the kernel subtracts a nice value from.
const ANSWER_OF_ZERO: i8 = 20;
/// The id that means the calling thread.
const THIS_THREAD: libc::id_t = 0;

/// Gives the calling thread this nice value or, where the kernel refuses, the
/// nearest that it permits; in that case the request counts as denied.
pub(super) fn set_nearest(requested: i8) -> Result<(), DeniedRequest> {
    let before = get();
    let first = match set(requested) {
        Ok(()) => return Ok(()),
        Err(errno) => errno,
    };
    let nearest = (requested + 1..before).find(|&nice| set(nice).is_ok());
    Err(DeniedRequest::by_kernel(
        format!("nice value {requested}"),
        first,
        format!(
            "it is {}; for less, give the program LimitNICE={requested} (a shell: ulimit -e {})",
            nearest.unwrap_or(before),
            ANSWER_OF_ZERO - requested,
        ),
    ))
}

fn set(nice: i8) -> Result<(), Errno> {
    // SAFETY: the call takes no pointer.
    let answer = unsafe {
        libc::syscall(
            libc::SYS_setpriority,
            libc::PRIO_PROCESS,
            THIS_THREAD,
            libc::c_int::from(nice),
        )
    };
    Errno::result(answer).map(drop)
}

/// The nice value of the calling thread.
pub(super) fn get() -> i8 {
    // SAFETY: the call takes no pointer.
    let answer = unsafe { libc::syscall(libc::SYS_getpriority, libc::PRIO_PROCESS, THIS_THREAD) };
    ANSWER_OF_ZERO - answer as i8
}

#[cfg(test)]
mod tests {
    use std::{fs, thread};

    use super::*;

    /// Field 19 of /proc/thread-self/stat (`proc_pid_stat(5)`).
    fn nice_of_this_thread() -> i8 {
        let stat = fs::read_to_string("/proc/thread-self/stat").unwrap();
        let after_name = stat.rsplit(") ").next().unwrap();
        after_name.split(' ').nth(19 - 3).unwrap().parse().unwrap()
    }

    #[test]
    fn a_thread_gets_a_nice_value_of_its_own() {
        let before = nice_of_this_thread();
        thread::spawn(|| {
            set_nearest(19).unwrap();
            assert_eq!((get(), nice_of_this_thread()), (19, 19));
        })
        .join()
        .unwrap();
        assert_eq!((get(), nice_of_this_thread()), (before, before));
    }

    /// Without the right to it, what `RLIMIT_NICE` permits is the nearest.
    #[test]
    fn what_is_refused_is_reported_with_what_it_is_instead() {
        thread::spawn(|| {
            let answer = set_nearest(-20);
            let now = nice_of_this_thread();
            match answer {
                Ok(()) => assert_eq!(now, -20),
                Err(denied) => {
                    assert!(now > -20);
                    let begins = format!("it is {now};");
                    assert!(denied.remedy.starts_with(&begins), "{denied}");
                }
            }
        })
        .join()
        .unwrap();
    }
}
