//! Wishes of a thread without any rights: every one is refused, reported with
//! what to do, and leaves no half-way state.
#![cfg(test)]
#![allow(unsafe_code)]

use nix::sys::resource::{Resource, rlim_t, setrlimit};
use std::thread;

use fcc_timer::{CpuWish, RealtimeWishes, Strictness};

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
        let wishes = RealtimeWishes {
            priority: Some(80),
            lock_memory: true,
            ..RealtimeWishes::default()
        };
        let grants = wishes.apply().unwrap();
        assert_eq!((grants.policy, grants.priority), ("SCHED_OTHER", 0));
        assert!(!grants.memory_locked);
        let [memory, scheduling] = grants.refused.as_slice() else {
            panic!("{:?}", grants.refused);
        };

        assert_eq!(scheduling.wish, "SCHED_FIFO priority 80");
        assert_eq!(scheduling.reason, "EPERM");
        assert!(scheduling.remedy.contains("LimitRTPRIO=80"));
        assert!(scheduling.remedy.contains("setcap cap_sys_nice+ep"));

        assert_eq!(memory.wish, "locked memory");
        assert!(memory.reason.contains("64 KiB"), "{}", memory.reason);
        assert!(memory.remedy.contains("LimitMEMLOCK=infinity"));
    });
}

#[test]
fn memory_that_may_not_be_locked_can_still_be_had() {
    without_rights(|| {
        let wishes = RealtimeWishes {
            lock_memory: true,
            ..RealtimeWishes::default()
        };
        assert_eq!(wishes.apply().unwrap().refused.len(), 1);
        let far_beyond_the_limit = vec![1_u8; 64 << 20];
        assert_eq!(std::hint::black_box(far_beyond_the_limit)[1 << 20], 1);
        thread::spawn(|| ()).join().unwrap();
    });
}

#[test]
fn strictly_a_refusal_is_an_error_that_tells_everything() {
    without_rights(|| {
        let wishes = RealtimeWishes {
            priority: Some(80),
            lock_memory: true,
            timer_slack_ns: Some(1000),
            strictness: Strictness::Strict,
            ..RealtimeWishes::default()
        };
        let error = wishes.apply().unwrap_err();
        assert_eq!(error.grants.refused.len(), 2);
        // What needs no right is granted all the same.
        assert_eq!(error.grants.timer_slack_ns, Some(1000));
        let message = error.to_string();
        assert!(
            message.contains("SCHED_FIFO priority 80 refused (EPERM): "),
            "{message}"
        );
        assert!(message.contains("locked memory refused ("), "{message}");
    });
}

#[test]
fn what_cannot_be_is_refused_to_everybody() {
    let refused = |wishes: RealtimeWishes| {
        let grants = thread::spawn(move || wishes.apply().unwrap())
            .join()
            .unwrap();
        let [refusal] = grants.refused.as_slice() else {
            panic!("{:?}", grants.refused);
        };
        (grants.clone(), refusal.clone())
    };

    for priority in [0, 100] {
        let (grants, refusal) = refused(RealtimeWishes {
            priority: Some(priority),
            ..RealtimeWishes::default()
        });
        assert_eq!(grants.policy, "SCHED_OTHER");
        assert!(refusal.remedy.contains("1 to 99"));
    }

    let (grants, refusal) = refused(RealtimeWishes {
        cpu: Some(CpuWish::Number(100_000)),
        ..RealtimeWishes::default()
    });
    assert_eq!(refusal.wish, "CPU 100000");
    assert!(grants.cpu.is_none_or(|cpu| cpu != 100_000));

    let (grants, refusal) = refused(RealtimeWishes {
        stack_prefault_bytes: 1 << 30,
        ..RealtimeWishes::default()
    });
    assert!(!grants.stack_prefaulted);
    assert!(refusal.remedy.contains("larger"), "{refusal}");

    let (grants, _) = refused(RealtimeWishes {
        timer_slack_ns: Some(0),
        ..RealtimeWishes::default()
    });
    assert_eq!(grants.timer_slack_ns, Some(50_000));
}
