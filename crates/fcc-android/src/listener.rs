//! Calls of the app's listener, from a thread of its own: what the app does in
//! them delays neither the loop nor the thread that reads its messages.

use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use jni::objects::JObject;
use jni::refs::Global;
use jni::strings::JNIStr;
use jni::{Env, JavaVM, jni_sig, jni_str};

/// Calls that may wait for the app; further ones are left out.
const MOST_WAITING: usize = 256;
/// Java objects that a call makes: its text, and a class to look its method up.
const LOCAL_REFERENCES: usize = 4;

/// What the app is told.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Notice {
    /// The loop's state is now this.
    State(String),
    /// An event, or a remark from outside the loop.
    Report(String),
    /// The flight is over, for this reason.
    Ended(String),
}

impl Notice {
    /// The method of `fcc.android.Listener`, and its argument.
    fn call(&self) -> (&'static JNIStr, &str) {
        match self {
            Self::State(words) => (jni_str!("stateChanged"), words),
            Self::Report(words) => (jni_str!("reported"), words),
            Self::Ended(words) => (jni_str!("ended"), words),
        }
    }
}

/// Tells the app's listener; without effect if there is none.
#[derive(Clone, Default)]
pub(crate) struct Notifier(Option<SyncSender<Notice>>);

impl Notifier {
    /// Tells this listener, if there is one. Its thread ends with the last copy
    /// of the notifier.
    ///
    /// # Errors
    /// When Java or the operating system has no room for it.
    pub(crate) fn of(
        env: &Env<'_>,
        listener: &JObject<'_>,
    ) -> jni::errors::Result<io::Result<Self>> {
        if listener.is_null() {
            return Ok(Ok(Self::default()));
        }
        let machine = env.get_java_vm()?;
        let listener = env.new_global_ref(listener)?;
        let (sender, notices) = sync_channel(MOST_WAITING);
        let started = thread::Builder::new()
            .name("fcc-listener".to_owned())
            .spawn(move || pass_on(&machine, &listener, &notices));
        Ok(started.map(|_| Self(Some(sender))))
    }

    /// Tells the app, without waiting.
    pub(crate) fn tell(&self, notice: Notice) {
        if let Some(sender) = &self.0 {
            // The state for the screens has it, too.
            let _ = sender.try_send(notice);
        }
    }
}

/// Calls the listener until no notifier is left.
fn pass_on(machine: &JavaVM, listener: &Global<JObject<'static>>, notices: &Receiver<Notice>) {
    for notice in notices {
        let (method, words) = notice.call();
        let called = machine.attach_current_thread(|env| {
            env.with_local_frame(LOCAL_REFERENCES, |env| -> jni::errors::Result<()> {
                let words = env.new_string(words)?;
                env.call_method(
                    listener,
                    method,
                    jni_sig!("(Ljava/lang/String;)V"),
                    &[(&words).into()],
                )?;
                Ok(())
            })
            // An exception of the listener is its own: here nobody can catch it.
            .inspect_err(|_| env.exception_clear())
        });
        if called.is_err() && machine.is_thread_attached().is_err() {
            return;
        }
    }
}
