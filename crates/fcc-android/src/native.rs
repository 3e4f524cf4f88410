//! The native methods of `fcc.android.Native`.
//!
//! Each catches its panics, and throws an exception for an error: see
//! `Throw`. Their names are Java's (JNI specification,
//! "Resolving Native Method Names").
#![allow(unsafe_code, reason = "Java finds a method by its symbol's name")]
#![allow(non_snake_case, reason = "names of methods are Java's")]
#![allow(
    clippy::too_many_arguments,
    reason = "a position has as many, and an object would be read field by field"
)]

use std::fs::File;
use std::os::fd::{FromRawFd, OwnedFd};
use std::path::PathBuf;
use std::sync::Arc;

use fcc_flight::config::Config;
use fcc_phone::PositionReport;
use jni::objects::{JClass, JObject, JString};
use jni::sys::{jdouble, jint, jlong};
use jni::{Env, EnvUnowned};

use crate::calibration::{self, Calibration};
use crate::computer::{self, Computer};
use crate::failure::{Failure, Throw};
use crate::handles::Handles;
use crate::listener::Notifier;
use crate::{release, report};

/// All that the app has open.
static COMPUTERS: Handles<Computer> = Handles::new();
static CALIBRATIONS: Handles<Calibration> = Handles::new();

/// Checks a configuration; the handle of a new flight control computer.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_create<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    config: JString<'local>,
    recordings: JString<'local>,
    package: JString<'local>,
    listener: JObject<'local>,
) -> jlong {
    env.with_env(|env| -> Result<jlong, Failure> {
        let config = config.try_to_string(env)?;
        let recordings = PathBuf::from(recordings.try_to_string(env)?);
        let package = package.try_to_string(env)?;
        let notifier = Notifier::of(env, &listener)?
            .map_err(|error| Failure::Flight(format!("no thread for the listener: {error}")))?;
        Ok(COMPUTERS.add(Computer::create(config, recordings, package, notifier)?))
    })
    .resolve::<Throw>()
}

/// Begins a flight; returns when its loop runs.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_start<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) {
    env.with_env(|_| COMPUTERS.get(handle)?.start())
        .resolve::<Throw>();
}

/// Ends the flight, and waits until it has ended.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_stop<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) {
    env.with_env(|_| -> Result<(), Failure> {
        COMPUTERS.get(handle)?.stop();
        Ok(())
    })
    .resolve::<Throw>();
}

/// The state now, as JSON.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_state<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) -> JString<'local> {
    env.with_env(|env| text(env, COMPUTERS.get(handle)?.state()))
        .resolve::<Throw>()
}

/// Sends a command, as JSON; the tick that read it.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_command<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
    command: JString<'local>,
) -> jlong {
    env.with_env(|env| -> Result<jlong, Failure> {
        let command = command.try_to_string(env)?;
        Ok(COMPUTERS.get(handle)?.command(&command)? as jlong)
    })
    .resolve::<Throw>()
}

/// Hands a position of the location service in; without effect while nothing flies
/// by it. What is not known is not a number.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_position<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
    elapsed_realtime_ns: jlong,
    latitude_deg: jdouble,
    longitude_deg: jdouble,
    altitude_m: jdouble,
    speed_mps: jdouble,
    bearing_deg: jdouble,
    horizontal_accuracy_m: jdouble,
    vertical_accuracy_m: jdouble,
    speed_accuracy_mps: jdouble,
) {
    let known = |number: jdouble| (!number.is_nan()).then_some(number);
    env.with_env(|_| -> Result<(), Failure> {
        COMPUTERS.get(handle)?.position(PositionReport {
            elapsed_realtime_ns,
            latitude_deg,
            longitude_deg,
            altitude_m,
            speed_mps,
            bearing_deg: known(bearing_deg),
            horizontal_accuracy_m: known(horizontal_accuracy_m),
            vertical_accuracy_m: known(vertical_accuracy_m),
            speed_accuracy_mps: known(speed_accuracy_mps),
        });
        Ok(())
    })
    .resolve::<Throw>();
}

/// The recordings, as JSON.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_recordings<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) -> JString<'local> {
    env.with_env(|env| text(env, COMPUTERS.get(handle)?.recordings()?))
        .resolve::<Throw>()
}

/// A report on a recording, as JSON.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_report<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    file: JString<'local>,
) -> JString<'local> {
    env.with_env(|env| {
        let file = PathBuf::from(file.try_to_string(env)?);
        text(env, report::of(&file)?)
    })
    .resolve::<Throw>()
}

/// The calibrations that a configuration has sensors for, and what was found, as JSON.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_calibrations<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    config: JString<'local>,
    recordings: JString<'local>,
) -> JString<'local> {
    env.with_env(|env| {
        let config = read_config(env, &config, &recordings)?;
        text(env, calibration::kinds(&config)?)
    })
    .resolve::<Throw>()
}

/// Begins a guided calibration; its handle.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_calibrate<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    config: JString<'local>,
    recordings: JString<'local>,
    package: JString<'local>,
    kind: JString<'local>,
) -> jlong {
    env.with_env(|env| -> Result<jlong, Failure> {
        let config = read_config(env, &config, &recordings)?;
        let (package, kind) = (package.try_to_string(env)?, kind.try_to_string(env)?);
        Ok(CALIBRATIONS.add(Calibration::begin(config, &package, &kind)?))
    })
    .resolve::<Throw>()
}

/// The state of a calibration, as JSON.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_calibration<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) -> JString<'local> {
    env.with_env(|env| text(env, CALIBRATIONS.get(handle)?.state()))
        .resolve::<Throw>()
}

/// Gives a calibration up that is not complete, and closes the handle; without effect
/// on one that is closed.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_endCalibration<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) {
    env.with_env(|_| -> Result<(), Failure> {
        drop(CALIBRATIONS.remove(handle));
        Ok(())
    })
    .resolve::<Throw>();
}

/// Hands over the pipe to the app's second process: its end that is written to.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_tellHelper<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    pipe: jint,
) {
    env.with_env(|_| -> Result<(), Failure> {
        // SAFETY: the caller has detached it, and does not use it any more.
        release::add_helper(unsafe { OwnedFd::from_raw_fd(pipe) });
        Ok(())
    })
    .resolve::<Throw>();
}

/// In the second process: reads the pipe until the first one ends, and releases what it
/// held; what became of it.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_helpRelease<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    pipe: jint,
    recordings: JString<'local>,
) -> JString<'local> {
    env.with_env(|env| {
        let recordings = PathBuf::from(recordings.try_to_string(env)?);
        // SAFETY: as above.
        let pipe = File::from(unsafe { OwnedFd::from_raw_fd(pipe) });
        text(env, release::serve(pipe, &recordings))
    })
    .resolve::<Throw>()
}

/// Releases what an earlier process has left held, if there is something; what became
/// of it.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_releaseLeft<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    recordings: JString<'local>,
) -> JString<'local> {
    env.with_env(|env| {
        let recordings = PathBuf::from(recordings.try_to_string(env)?);
        text(env, release::release_left(&recordings))
    })
    .resolve::<Throw>()
}

/// Ends the flight, and closes the handle; without effect on one that is closed.
#[unsafe(no_mangle)]
pub extern "system" fn Java_fcc_android_Native_close<'local>(
    mut env: EnvUnowned<'local>,
    _: JClass<'local>,
    handle: jlong,
) {
    env.with_env(|_| -> Result<(), Failure> {
        // Other threads may still use it, and its last user drops it.
        if let Some(computer) = COMPUTERS.remove(handle) {
            computer.stop();
            drop(Arc::into_inner(computer));
        }
        Ok(())
    })
    .resolve::<Throw>();
}

fn read_config(
    env: &Env<'_>,
    config: &JString<'_>,
    recordings: &JString<'_>,
) -> Result<Config, Failure> {
    let text = config.try_to_string(env)?;
    computer::read(&text, PathBuf::from(recordings.try_to_string(env)?))
}

fn text<'local>(env: &mut Env<'local>, words: String) -> Result<JString<'local>, Failure> {
    Ok(env.new_string(words)?)
}
