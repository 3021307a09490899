//! Progress out of, and cancellation into, calls that may take long.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Tells a running call to stop. Clones share one state.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// A token that nobody has cancelled yet.
    pub fn new() -> CancelToken {
        CancelToken::default()
    }

    /// Asks every call that holds a clone of this token to stop soon.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`CancelToken::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

type Callback = Arc<dyn Fn(&str, f64) + Send + Sync>;

/// What a long call reports to and listens to. The default reports nothing and is never cancelled.
#[derive(Clone, Default)]
pub struct Watch {
    progress: Option<Callback>,
    cancel: CancelToken,
}

impl Watch {
    /// Reports to `progress`: the stage's name and the share of it that is done, in 0..=1. It may be called from any
    /// thread.
    pub fn with_progress(mut self, progress: impl Fn(&str, f64) + Send + Sync + 'static) -> Watch {
        self.progress = Some(Arc::new(progress));
        self
    }

    /// Listens to `cancel`.
    pub fn with_cancel(mut self, cancel: CancelToken) -> Watch {
        self.cancel = cancel;
        self
    }

    /// Reports that `done` (0..=1) of `stage` is done.
    pub fn report(&self, stage: &str, done: f64) {
        if let Some(progress) = &self.progress {
            progress(stage, done);
        }
    }

    /// Whether to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    /// `Err` if the call shall stop.
    ///
    /// # Errors
    /// [`Cancelled`] once the token was cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch")
            .field("progress", &self.progress.is_some())
            .field("cancelled", &self.is_cancelled())
            .finish()
    }
}

/// The call was cancelled through its [`CancelToken`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;
