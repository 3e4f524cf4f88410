//! Errors and panics as Java exceptions.

use std::any::Any;

use jni::Env;
use jni::errors::ErrorPolicy;
use jni::jni_str;
use jni::strings::{JNIStr, JNIString};

/// Why a native method failed: each kind is an exception of its own.
#[derive(thiserror::Error, Debug)]
pub(crate) enum Failure {
    /// The configuration cannot be flown: every problem with its line and key.
    #[error("{0}")]
    Config(String),
    /// A flight did not begin.
    #[error("{0}")]
    Flight(String),
    /// A command was refused.
    #[error("{0}")]
    Command(String),
    /// The recordings cannot be listed, or one cannot be read.
    #[error("{0}")]
    Recording(String),
    /// A calibration did not begin.
    #[error("{0}")]
    Calibration(String),
    /// The handle is closed, or never was one.
    #[error("this flight control computer is closed: create another")]
    Closed,
    /// Java failed.
    #[error("the Java virtual machine: {0}")]
    Java(#[from] jni::errors::Error),
}

impl Failure {
    fn class(&self) -> &'static JNIStr {
        match self {
            Self::Config(_) => jni_str!("fcc/android/ConfigException"),
            Self::Flight(_) => jni_str!("fcc/android/FlightException"),
            Self::Command(_) => jni_str!("fcc/android/CommandException"),
            Self::Recording(_) => jni_str!("fcc/android/RecordingException"),
            Self::Calibration(_) => jni_str!("fcc/android/CalibrationException"),
            Self::Closed => jni_str!("fcc/android/ClosedException"),
            Self::Java(_) => INTERNAL,
        }
    }
}

/// What is an error of this library.
const INTERNAL: &JNIStr = jni_str!("fcc/android/InternalException");

/// Throws errors and panics, and returns 0 or null.
pub(crate) struct Throw;

impl<T: Default> ErrorPolicy<T, Failure> for Throw {
    type Captures<'unowned_env_local: 'native_method, 'native_method> = ();

    fn on_error<'unowned_env_local: 'native_method, 'native_method>(
        env: &mut Env<'unowned_env_local>,
        (): &mut (),
        failure: Failure,
    ) -> jni::errors::Result<T> {
        throw(env, failure.class(), &failure.to_string());
        Ok(T::default())
    }

    fn on_panic<'unowned_env_local: 'native_method, 'native_method>(
        env: &mut Env<'unowned_env_local>,
        (): &mut (),
        payload: Box<dyn Any + Send>,
    ) -> jni::errors::Result<T> {
        throw(env, INTERNAL, &panic_message(payload));
        Ok(T::default())
    }
}

/// Throws, unless an exception is thrown already.
fn throw(env: &mut Env<'_>, class: &JNIStr, message: &str) {
    if !env.exception_check() {
        // It returns the exception as an error.
        let _ = env.throw_new(class, JNIString::from(message));
    }
}

/// What a panic said, as a message for users.
pub(crate) fn panic_message(payload: Box<dyn Any + Send>) -> String {
    let words = match payload.downcast::<String>() {
        Ok(words) => *words,
        Err(payload) => payload
            .downcast_ref::<&str>()
            .copied()
            .unwrap_or("no message")
            .to_owned(),
    };
    format!("an error of the program, please report it: {words}")
}

#[cfg(test)]
mod tests {
    use std::panic::catch_unwind;

    use super::*;

    #[test]
    fn a_panic_is_told_with_its_message() {
        let said = |panics: fn()| panic_message(catch_unwind(panics).unwrap_err());
        assert!(said(|| panic!("plain")).ends_with("report it: plain"));
        assert!(said(|| panic!("{} of {}", 1, 2)).ends_with("report it: 1 of 2"));
        assert!(said(|| std::panic::panic_any(3)).ends_with("no message"));
    }
}
