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

use std::path::PathBuf;
use std::sync::Arc;

use fcc_phone::PositionReport;
use jni::objects::{JClass, JObject, JString};
use jni::sys::{jdouble, jlong};
use jni::{Env, EnvUnowned};

use crate::computer::Computer;
use crate::failure::{Failure, Throw};
use crate::handles::Handles;
use crate::listener::Notifier;
use crate::report;

/// All that the app has open.
static COMPUTERS: Handles<Computer> = Handles::new();

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

fn text<'local>(env: &mut Env<'local>, words: String) -> Result<JString<'local>, Failure> {
    Ok(env.new_string(words)?)
}
