//! Wishes of a thread without any rights: every one is refused, reported with
//! what to do, and leaves no half-way state.
//!
//! A process of its own: limits are of the whole process.
#![cfg(test)]
#![allow(unsafe_code)]

use nix::sys::resource::{Resource, rlim_t, setrlimit};
use std::thread;

use fcc_timer::{CpuRequest, RealtimeRequest, Strictness};

const ALLOWED_BYTES: rlim_t = 64 << 10;

/// Runs a check in a thread that may do no more than anybody may.
fn without_rights(check: fn()) {
    thread::spawn(move || {
        // Lowering a limit is always allowed.
        setrlimit(Resource::RLIMIT_MEMLOCK, ALLOWED_BYTES, ALLOWED_BYTES).unwrap();
        setrlimit(Resource::RLIMIT_RTPRIO, 0, 0).unwrap();
        give_up_capabilities();
        check();
    })
    .join()
    .unwrap();
}

/// Empties the capabilities of the calling thread, as capset(2) describes.
fn give_up_capabilities() {
    const VERSION_3: u32 = 0x2008_0522;
    let header = [VERSION_3, 0];
    let none = [0_u32; 6];
    // SAFETY: the kernel reads two numbers and six, during the call.
    let answer = unsafe { libc::syscall(libc::SYS_capset, &raw const header, &raw const none) };
    assert_eq!(answer, 0);
}

#[test]
fn a_refusal_says_what_why_and_what_to_do() {
    without_rights(|| {
        let request = RealtimeRequest {
            priority: Some(80),
            lock_memory: true,
            ..RealtimeRequest::default()
        };
        let granted = request.apply().unwrap();
        assert_eq!((granted.policy, granted.priority), ("SCHED_OTHER", 0));
        assert!(!granted.memory_locked);
        let [memory, scheduling] = granted.denied.as_slice() else {
            panic!("{:?}", granted.denied);
        };

        assert_eq!(scheduling.request, "SCHED_FIFO priority 80");
        assert_eq!(scheduling.reason, "EPERM");
        assert!(scheduling.remedy.contains("LimitRTPRIO=80"));
        assert!(scheduling.remedy.contains("setcap cap_sys_nice+ep"));

        assert_eq!(memory.request, "locked memory");
        assert!(memory.reason.contains("64 KiB"), "{}", memory.reason);
        assert!(memory.remedy.contains("LimitMEMLOCK=infinity"));
    });
}

#[test]
fn memory_that_may_not_be_locked_can_still_be_had() {
    without_rights(|| {
        let request = RealtimeRequest {
            lock_memory: true,
            ..RealtimeRequest::default()
        };
        assert_eq!(request.apply().unwrap().denied.len(), 1);
        let far_beyond_the_limit = vec![1_u8; 64 << 20];
        assert_eq!(std::hint::black_box(far_beyond_the_limit)[1 << 20], 1);
        thread::spawn(|| ()).join().unwrap();
    });
}

#[test]
fn strictly_a_refusal_is_an_error_with_all_details() {
    without_rights(|| {
        let request = RealtimeRequest {
            priority: Some(80),
            lock_memory: true,
            timer_slack_ns: Some(1000),
            strictness: Strictness::Strict,
            ..RealtimeRequest::default()
        };
        let error = request.apply().unwrap_err();
        assert_eq!(error.granted.denied.len(), 2);
        // What needs no right is granted all the same.
        assert_eq!(error.granted.timer_slack_ns, Some(1000));
        let message = error.to_string();
        assert!(
            message.contains("SCHED_FIFO priority 80 denied (EPERM): "),
            "{message}"
        );
        assert!(message.contains("locked memory denied ("), "{message}");
    });
}

#[test]
fn an_impossible_request_is_denied_to_every_user() {
    let refused = |request: RealtimeRequest| {
        let granted = thread::spawn(move || request.apply().unwrap())
            .join()
            .unwrap();
        let [denied] = granted.denied.as_slice() else {
            panic!("{:?}", granted.denied);
        };
        (granted.clone(), denied.clone())
    };

    for priority in [0, 100] {
        let (granted, denied) = refused(RealtimeRequest {
            priority: Some(priority),
            ..RealtimeRequest::default()
        });
        assert_eq!(granted.policy, "SCHED_OTHER");
        assert!(denied.remedy.contains("1 to 99"));
    }

    let (granted, denied) = refused(RealtimeRequest {
        cpu: Some(CpuRequest::Number(100_000)),
        ..RealtimeRequest::default()
    });
    assert_eq!(denied.request, "CPU 100000");
    assert!(granted.cpu.is_none_or(|cpu| cpu != 100_000));

    let (granted, denied) = refused(RealtimeRequest {
        stack_prefault_bytes: 1 << 30,
        ..RealtimeRequest::default()
    });
    assert!(!granted.stack_prefaulted);
    assert!(denied.remedy.contains("larger"), "{denied}");

    let (granted, _) = refused(RealtimeRequest {
        timer_slack_ns: Some(0),
        ..RealtimeRequest::default()
    });
    assert_eq!(granted.timer_slack_ns, Some(50_000));
}
