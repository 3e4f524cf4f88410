//! The functions of `libandroid.so` (NDK: `android/looper.h`, `android/sensor.h`), and
//! an event queue of them.
#![allow(unsafe_code, reason = "Android's interface is C's")]

use core::ffi::{CStr, c_char, c_int, c_void};
use core::ptr;
use core::time::Duration;
use std::sync::OnceLock;

use fcc_device::DeviceError;

/// `ALOOPER_PREPARE_ALLOW_NON_CALLBACKS`: events are asked for.
const NON_CALLBACKS: c_int = 1;
/// `ALOOPER_POLL_ERROR`.
const POLL_ERROR: c_int = -4;
/// What the looper is to call the queue.
const IDENT: c_int = 1;
/// Events that are taken at once: a third of a second of a fast sensor.
const EVENTS: usize = 64;

/// `ASensorEvent`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    version: i32,
    sensor: i32,
    /// `ASENSOR_TYPE_...`.
    pub(crate) sensor_type: i32,
    reserved0: i32,
    /// ns, of a clock that is to be found out.
    pub(crate) timestamp: i64,
    /// The values of its type.
    pub(crate) data: [f32; 16],
    flags: u32,
    reserved1: [i32; 3],
}

const _: () = assert!(size_of::<Event>() == 104, "as sensor.h has it");

impl Event {
    const NONE: Self = Self {
        version: 0,
        sensor: 0,
        sensor_type: 0,
        reserved0: 0,
        timestamp: 0,
        data: [0.0; 16],
        flags: 0,
        reserved1: [0; 3],
    };
}

/// Declares the functions once: linked on Android, loaded elsewhere.
macro_rules! functions {
    ($(fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        #[allow(non_snake_case, reason = "names of functions are C's")]
        struct Functions {
            $($name: unsafe extern "C" fn($($type),*) -> $result,)*
            /// Not unloaded while its functions are here.
            #[cfg(not(target_os = "android"))]
            _library: libloading::Library,
        }

        #[cfg(target_os = "android")]
        mod linked {
            use super::*;

            #[link(name = "android")]
            unsafe extern "C" {
                $(pub(super) fn $name($($argument: $type),*) -> $result;)*
            }
        }

        impl Functions {
            #[cfg(target_os = "android")]
            #[allow(clippy::unnecessary_wraps, reason = "elsewhere it can fail")]
            fn load() -> Result<Self, String> {
                Ok(Self { $($name: linked::$name,)* })
            }

            #[cfg(not(target_os = "android"))]
            fn load() -> Result<Self, String> {
                // SAFETY: its initialisers are those of a library of this project.
                let library = unsafe { libloading::Library::new(LIBRARY) };
                let library = library.map_err(|error| error.to_string())?;
                Ok(Self {
                    // SAFETY: declared as in the NDK.
                    $($name: *unsafe { library.get(stringify!($name).as_bytes()) }
                        .map_err(|error| error.to_string())?,)*
                    _library: library,
                })
            }
        }
    };
}

/// The name of Android's library for native apps.
pub(crate) const LIBRARY: &str = "libandroid.so";

functions! {
    fn ALooper_prepare(options: c_int) -> *mut c_void;
    fn ALooper_pollOnce(
        timeout_ms: c_int, fd: *mut c_int, events: *mut c_int, data: *mut *mut c_void
    ) -> c_int;
    fn ASensorManager_getInstanceForPackage(package: *const c_char) -> *mut c_void;
    fn ASensorManager_getDefaultSensor(manager: *mut c_void, of_type: c_int) -> *const c_void;
    fn ASensorManager_createEventQueue(
        manager: *mut c_void, looper: *mut c_void, ident: c_int, callback: *const c_void,
        data: *mut c_void
    ) -> *mut c_void;
    fn ASensorManager_destroyEventQueue(manager: *mut c_void, queue: *mut c_void) -> c_int;
    fn ASensorEventQueue_enableSensor(queue: *mut c_void, sensor: *const c_void) -> c_int;
    fn ASensorEventQueue_setEventRate(
        queue: *mut c_void, sensor: *const c_void, period_us: i32
    ) -> c_int;
    fn ASensorEventQueue_disableSensor(queue: *mut c_void, sensor: *const c_void) -> c_int;
    fn ASensorEventQueue_getEvents(queue: *mut c_void, events: *mut Event, count: usize) -> isize;
    fn ASensor_getName(sensor: *const c_void) -> *const c_char;
    fn ASensor_getMinDelay(sensor: *const c_void) -> c_int;
}

/// The functions, loaded once.
fn functions(device: &str) -> Result<&'static Functions, DeviceError> {
    static LOADED: OnceLock<Functions> = OnceLock::new();
    if let Some(loaded) = LOADED.get() {
        return Ok(loaded);
    }
    let loaded = Functions::load().map_err(|error| {
        refused(
            device,
            format!("this is no phone: its sensors are those of Android ({error})"),
        )
    })?;
    Ok(LOADED.get_or_init(|| loaded))
}

pub(crate) fn refused(device: &str, what: String) -> DeviceError {
    DeviceError::Refused {
        device: device.to_owned(),
        what,
    }
}

/// The event queue of one sensor, for the thread that opened it: its looper is that
/// thread's.
pub(crate) struct EventQueue {
    functions: &'static Functions,
    device: &'static str,
    manager: *mut c_void,
    queue: *mut c_void,
    sensor: *const c_void,
    events: [Event; EVENTS],
}

impl EventQueue {
    /// Opens the first sensor of these types that there is, and asks it for a rate; the
    /// queue, the sensor's type, and the rate that was asked of it: no higher than it
    /// can.
    ///
    /// # Errors
    /// When there is none, or it refuses.
    pub(crate) fn open(
        device: &'static str,
        package: &CStr,
        types: &[i32],
        rate_hz: f64,
    ) -> Result<(Self, i32, f64), DeviceError> {
        let functions = functions(device)?;
        // SAFETY: the package's name ends with 0.
        let manager = unsafe { (functions.ASensorManager_getInstanceForPackage)(package.as_ptr()) };
        if manager.is_null() {
            return Err(refused(device, "Android gives no sensors to it".to_owned()));
        }
        let found = types.iter().find_map(|of_type| {
            // SAFETY: the manager is one.
            let sensor = unsafe { (functions.ASensorManager_getDefaultSensor)(manager, *of_type) };
            (!sensor.is_null()).then_some((*of_type, sensor))
        });
        let Some((of_type, sensor)) = found else {
            return Err(refused(device, "this phone has none".to_owned()));
        };
        // SAFETY: it takes a number alone.
        let looper = unsafe { (functions.ALooper_prepare)(NON_CALLBACKS) };
        // SAFETY: manager and looper are such; there is no callback.
        let queue = unsafe {
            (functions.ASensorManager_createEventQueue)(
                manager,
                looper,
                IDENT,
                ptr::null(),
                ptr::null_mut(),
            )
        };
        if queue.is_null() {
            return Err(refused(
                device,
                "Android gives it no event queue".to_owned(),
            ));
        }
        let opened = Self {
            functions,
            device,
            manager,
            queue,
            sensor,
            events: [Event::NONE; EVENTS],
        };
        let asked_hz = opened.enable(rate_hz)?;
        Ok((opened, of_type, asked_hz))
    }

    fn enable(&self, rate_hz: f64) -> Result<f64, DeviceError> {
        // SAFETY: the sensor is one.
        let fastest_us = unsafe { (self.functions.ASensor_getMinDelay)(self.sensor) };
        let period_us = ((1e6 / rate_hz) as i32).max(fastest_us);
        // SAFETY: queue and sensor are such; the rate is set after enabling, which would
        // set it to the default.
        let (enabled, set) = unsafe {
            (
                (self.functions.ASensorEventQueue_enableSensor)(self.queue, self.sensor),
                (self.functions.ASensorEventQueue_setEventRate)(self.queue, self.sensor, period_us),
            )
        };
        match (enabled, set) {
            (0.., 0..) => Ok(1e6 / f64::from(period_us.max(1))),
            (error, 0..) | (_, error) => Err(refused(
                self.device,
                format!("Android refuses {rate_hz:.0} events a second (error {error})"),
            )),
        }
    }

    /// What the phone calls the sensor.
    pub(crate) fn name(&self) -> String {
        // SAFETY: the sensor is one, and its name ends with 0.
        let name = unsafe {
            let name = (self.functions.ASensor_getName)(self.sensor);
            (!name.is_null()).then(|| CStr::from_ptr(name))
        };
        name.map(|name| name.to_string_lossy().into_owned())
            .unwrap_or_default()
    }

    /// Waits for events; none if there are none within this time.
    ///
    /// # Errors
    /// When Android cannot wait.
    pub(crate) fn wait(&mut self, at_most: Duration) -> Result<&[Event], DeviceError> {
        let none = ptr::null_mut();
        // SAFETY: in the thread that prepared the looper; nothing is to be written.
        let polled = unsafe {
            (self.functions.ALooper_pollOnce)(
                at_most.as_millis() as c_int,
                none,
                none,
                ptr::null_mut(),
            )
        };
        if polled == POLL_ERROR {
            return Err(refused(self.device, "its looper has failed".to_owned()));
        }
        // SAFETY: there is room for so many events.
        let taken = unsafe {
            (self.functions.ASensorEventQueue_getEvents)(
                self.queue,
                self.events.as_mut_ptr(),
                EVENTS,
            )
        };
        // Negative: there are none.
        let taken = usize::try_from(taken).unwrap_or(0);
        Ok(self.events.get(..taken).unwrap_or_default())
    }
}

impl Drop for EventQueue {
    fn drop(&mut self) {
        // SAFETY: both are such, and not used any more.
        unsafe {
            (self.functions.ASensorEventQueue_disableSensor)(self.queue, self.sensor);
            (self.functions.ASensorManager_destroyEventQueue)(self.manager, self.queue);
        }
    }
}
