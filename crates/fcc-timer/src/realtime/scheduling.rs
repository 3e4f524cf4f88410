//! Policy, priority and CPU of the calling thread.
//!
//! The system calls are made directly: they concern one thread, and musl's
//! functions of the same names, which POSIX wants to concern the process,
//! always fail.
#![allow(unsafe_code)]

use nix::errno::Errno;
use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;

use super::DeniedRequest;

/// The thread id that means the calling thread.
const THIS_THREAD: libc::pid_t = 0;

/// Puts the calling thread under `SCHED_FIFO`. Threads and processes it creates
/// do not inherit that.
pub(super) fn become_fifo(priority: u8) -> Result<(), DeniedRequest> {
    let request = format!("SCHED_FIFO priority {priority}");
    if !(1..=99).contains(&priority) {
        return Err(DeniedRequest {
            request,
            reason: "EINVAL".to_owned(),
            remedy: "choose a priority from 1 to 99".to_owned(),
        });
    }
    // All that the kernel reads of a `sched_param`.
    let param = libc::c_int::from(priority);
    // SAFETY: the kernel reads one int through the pointer, during the call.
    let answer = unsafe {
        libc::syscall(
            libc::SYS_sched_setscheduler,
            THIS_THREAD,
            libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK,
            &raw const param,
        )
    };
    let remedy = remedy_for(priority, Errno::EPERM);
    Errno::result(answer).map_err(|errno| {
        DeniedRequest::by_kernel(request.clone(), errno, remedy_for(priority, errno))
    })?;
    if policy() == "SCHED_FIFO" && static_priority() == i32::from(priority) {
        Ok(())
    } else {
        let reason = format!("reads back as {} {}", policy(), static_priority());
        Err(DeniedRequest {
            request,
            reason,
            remedy,
        })
    }
}

/// What to do if the kernel denies `SCHED_FIFO` for this reason.
fn remedy_for(priority: u8, errno: Errno) -> String {
    match errno {
        Errno::ENOMEM => "the kernel has no memory for it: raise the limit on the address space, \
                          LimitAS (a shell: ulimit -v unlimited)"
            .to_owned(),
        _ => format!(
            "give the service LimitRTPRIO={priority} (a shell: ulimit -r {priority}), \
             or the program the right to: setcap cap_sys_nice+ep"
        ),
    }
}

/// The calling thread, as the kernel numbers it.
pub fn this_thread() -> i32 {
    nix::unistd::gettid().as_raw()
}

/// Puts a thread of this process back under `SCHED_OTHER`: one that hangs blocks
/// a CPU for everything of lower priority. Needs no privilege.
///
/// # Errors
/// When there is no such thread.
pub fn take_priority_from(thread: i32) -> std::io::Result<()> {
    // 0 means the calling thread.
    if thread <= 0 {
        return Err(Errno::ESRCH.into());
    }
    // All that the kernel reads of a `sched_param`; 0 is the only priority
    // under SCHED_OTHER.
    let param: libc::c_int = 0;
    // SAFETY: the kernel reads one int through the pointer, during the call.
    let answer = unsafe {
        libc::syscall(
            libc::SYS_sched_setscheduler,
            thread,
            libc::SCHED_NORMAL | libc::SCHED_RESET_ON_FORK,
            &raw const param,
        )
    };
    Errno::result(answer).map(|_| ()).map_err(Into::into)
}

/// The policy that the calling thread is under.
pub(super) fn policy() -> &'static str {
    // SAFETY: the call takes no pointer.
    let answer = unsafe { libc::syscall(libc::SYS_sched_getscheduler, THIS_THREAD) };
    match answer as libc::c_int & !libc::SCHED_RESET_ON_FORK {
        // As the kernel names what POSIX names SCHED_OTHER.
        libc::SCHED_NORMAL => "SCHED_OTHER",
        libc::SCHED_FIFO => "SCHED_FIFO",
        libc::SCHED_RR => "SCHED_RR",
        libc::SCHED_BATCH => "SCHED_BATCH",
        libc::SCHED_IDLE => "SCHED_IDLE",
        libc::SCHED_DEADLINE => "SCHED_DEADLINE",
        _ => "unknown",
    }
}

/// The real-time priority of the calling thread, 0 if it has none.
pub(super) fn static_priority() -> i32 {
    let mut param: libc::c_int = 0;
    // SAFETY: the kernel writes one int through the pointer, during the call.
    // Should it refuse, the 0 stays.
    unsafe { libc::syscall(libc::SYS_sched_getparam, THIS_THREAD, &raw mut param) };
    param
}

/// Keeps the calling thread on one CPU.
pub(super) fn pin_to(cpu: usize) -> Result<(), DeniedRequest> {
    let allowed = allowed_cpus();
    let mut requested = CpuSet::new();
    requested
        .set(cpu)
        .and_then(|()| sched_setaffinity(Pid::from_raw(THIS_THREAD), &requested))
        .map_err(|errno| {
            let allowed: Vec<String> = allowed.iter().map(ToString::to_string).collect();
            DeniedRequest::by_kernel(
                format!("CPU {cpu}"),
                errno,
                format!(
                    "choose a CPU that this thread may use: {}",
                    allowed.join(", ")
                ),
            )
        })
}

/// The CPU of the calling thread, if it may run on one only.
pub(super) fn only_cpu() -> Option<usize> {
    match allowed_cpus().as_slice() {
        [cpu] => Some(*cpu),
        _ => None,
    }
}

pub(super) fn allowed_cpus() -> Vec<usize> {
    sched_getaffinity(Pid::from_raw(THIS_THREAD)).map_or_else(
        |_| Vec::new(),
        |set| {
            (0..CpuSet::count())
                .filter(|&cpu| set.is_set(cpu) == Ok(true))
                .collect()
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remedy_is_for_the_kernels_reason() {
        assert!(remedy_for(80, Errno::EPERM).contains("LimitRTPRIO=80"));
        let remedy = remedy_for(80, Errno::ENOMEM);
        assert!(remedy.contains("LimitAS") && !remedy.contains("LimitRTPRIO"));
    }
}
