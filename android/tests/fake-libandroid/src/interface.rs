//! The functions of Android's that are played (`android/looper.h`, `android/sensor.h`).
//!
//! What has an address on a phone has one here that is never freed: a test is short.
#![allow(unsafe_code, reason = "Android's interface is C's")]
#![allow(non_snake_case, reason = "names of functions are C's")]
#![allow(clippy::missing_safety_doc, reason = "as in the NDK")]

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::control::listen;
use crate::played::{Event, PLAYED};

const POLL_TIMEOUT: c_int = -3;
const IDENT: c_int = 1;
const INVALID: c_int = -libc::EINVAL;
/// `SENSOR_DELAY_NORMAL`.
const USUAL_PERIOD_US: u64 = 200_000;

pub(crate) struct Sensor {
    of_type: i32,
    name: CString,
}

/// Sensors by package and type.
static SENSORS: Mutex<BTreeMap<(String, i32), &'static Sensor>> = Mutex::new(BTreeMap::new());
/// Packages by the address of their manager.
static MANAGERS: Mutex<BTreeMap<String, &'static String>> = Mutex::new(BTreeMap::new());

/// The looper of this thread: a number, 1 or more.
fn looper() -> usize {
    static LAST: AtomicUsize = AtomicUsize::new(0);
    thread_local! {
        static OWN: usize = LAST.fetch_add(1, Ordering::Relaxed) + 1;
    }
    OWN.with(|own| *own)
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn ALooper_prepare(_options: c_int) -> *mut c_void {
    ptr::without_provenance_mut(looper())
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn ALooper_pollOnce(
    timeout_ms: c_int,
    _fd: *mut c_int,
    _events: *mut c_int,
    _data: *mut *mut c_void,
) -> c_int {
    let at_most = Duration::from_millis(u64::try_from(timeout_ms).unwrap_or(u64::MAX / 2_000));
    if PLAYED.wait(looper(), at_most) {
        IDENT
    } else {
        POLL_TIMEOUT
    }
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorManager_getInstanceForPackage(
    package: *const c_char,
) -> *mut c_void {
    listen();
    // SAFETY: a name ends with 0.
    let package = unsafe { CStr::from_ptr(package) };
    let package = package.to_string_lossy().into_owned();
    let mut managers = MANAGERS.lock().unwrap_or_else(PoisonError::into_inner);
    let manager = managers
        .entry(package.clone())
        .or_insert_with(|| Box::leak(Box::new(package)));
    ptr::from_ref::<String>(manager).cast_mut().cast()
}

/// The package of a manager.
unsafe fn package_of<'a>(manager: *mut c_void) -> Option<&'a String> {
    // SAFETY: a manager is such an address.
    unsafe { manager.cast::<String>().as_ref() }
}

/// The type of a sensor.
unsafe fn type_of(sensor: *const c_void) -> Option<i32> {
    // SAFETY: a sensor is such an address.
    unsafe { sensor.cast::<Sensor>().as_ref() }.map(|sensor| sensor.of_type)
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorManager_getDefaultSensor(
    manager: *mut c_void,
    of_type: c_int,
) -> *const c_void {
    // SAFETY: as the caller says.
    let Some(package) = (unsafe { package_of(manager) }) else {
        return ptr::null();
    };
    if PLAYED.sensor(package, of_type).is_none() {
        return ptr::null();
    }
    let mut sensors = SENSORS.lock().unwrap_or_else(PoisonError::into_inner);
    let sensor = sensors
        .entry((package.clone(), of_type))
        .or_insert_with(|| {
            Box::leak(Box::new(Sensor {
                of_type,
                name: CString::new(format!("{package} of type {of_type}")).unwrap_or_default(),
            }))
        });
    ptr::from_ref::<Sensor>(sensor).cast()
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorManager_createEventQueue(
    manager: *mut c_void,
    looper: *mut c_void,
    _ident: c_int,
    _callback: *const c_void,
    _data: *mut c_void,
) -> *mut c_void {
    // SAFETY: as the caller says.
    match unsafe { package_of(manager) } {
        Some(package) => ptr::without_provenance_mut(PLAYED.create_queue(package, looper.addr())),
        None => ptr::null_mut(),
    }
}

#[unsafe(no_mangle)]
pub(crate) extern "C" fn ASensorManager_destroyEventQueue(
    _manager: *mut c_void,
    queue: *mut c_void,
) -> c_int {
    if PLAYED.destroy_queue(queue.addr()) {
        0
    } else {
        INVALID
    }
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorEventQueue_enableSensor(
    queue: *mut c_void,
    sensor: *const c_void,
) -> c_int {
    // SAFETY: as the caller says.
    let of_type = unsafe { type_of(sensor) };
    let enabled =
        of_type.is_some_and(|of_type| PLAYED.enable(queue.addr(), of_type, USUAL_PERIOD_US));
    if enabled { 0 } else { INVALID }
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorEventQueue_setEventRate(
    queue: *mut c_void,
    sensor: *const c_void,
    period_us: i32,
) -> c_int {
    // SAFETY: as the caller says.
    let of_type = unsafe { type_of(sensor) };
    let period_us = u64::try_from(period_us).unwrap_or(USUAL_PERIOD_US);
    let set = of_type.is_some_and(|of_type| PLAYED.enable(queue.addr(), of_type, period_us));
    if set { 0 } else { INVALID }
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorEventQueue_disableSensor(
    queue: *mut c_void,
    sensor: *const c_void,
) -> c_int {
    // SAFETY: as the caller says.
    let of_type = unsafe { type_of(sensor) };
    let disabled = of_type.is_some_and(|of_type| PLAYED.disable(queue.addr(), of_type));
    if disabled { 0 } else { INVALID }
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensorEventQueue_getEvents(
    queue: *mut c_void,
    events: *mut Event,
    count: usize,
) -> isize {
    let taken = PLAYED.take(queue.addr(), count);
    if taken.is_empty() {
        return -(libc::EAGAIN as isize);
    }
    for (number, event) in taken.iter().enumerate() {
        // SAFETY: there is room for `count`.
        unsafe { events.add(number).write(*event) };
    }
    taken.len() as isize
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensor_getName(sensor: *const c_void) -> *const c_char {
    // SAFETY: as the caller says.
    let sensor = unsafe { sensor.cast::<Sensor>().as_ref() };
    sensor.map_or(ptr::null(), |sensor| sensor.name.as_ptr())
}

#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn ASensor_getMinDelay(sensor: *const c_void) -> c_int {
    let sensors = SENSORS.lock().unwrap_or_else(PoisonError::into_inner);
    let this = |one: &&Sensor| ptr::from_ref::<Sensor>(one).cast::<c_void>() == sensor;
    let found = sensors.iter().find(|(_, one)| this(one));
    let played = found.and_then(|((package, of_type), _)| PLAYED.sensor(package, *of_type));
    played.map_or(0, |played| played.min_delay_us())
}
