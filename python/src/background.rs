//! Work in a thread of its own, while Python's main thread looks for Ctrl-C.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::exception;

/// Signals are looked for so often.
const PAUSE: Duration = Duration::from_millis(50);
/// Work that does not heed an interruption for so long goes on by itself, and its result is dropped.
const GRACE: Duration = Duration::from_secs(2);
/// As much as a main thread usually has, bytes.
const STACK: usize = 8 << 20;

/// What came of some work, and the exception of a signal that came meanwhile.
pub struct Done<T> {
    pub value: T,
    pub interrupted: Option<PyErr>,
}

impl<T> Done<T> {
    /// What came of it, unless it was interrupted.
    pub fn whole(self) -> PyResult<T> {
        self.interrupted.map_or(Ok(self.value), Err)
    }
}

/// Does some work without the interpreter's lock; its flag becomes true on Ctrl-C.
///
/// # Errors
/// That of a signal whose interruption the work does not heed; a panic, as an error of the package.
pub fn in_background<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Arc<AtomicBool>) -> T + Send + 'static,
) -> PyResult<Done<T>> {
    let flag = Arc::new(AtomicBool::new(false));
    let (tell, mut told) = mpsc::channel();
    let seen = flag.clone();
    Builder::new().stack_size(STACK).spawn(move || {
        // Whoever gave up does not listen.
        let _ = tell.send(catch_unwind(AssertUnwindSafe(|| work(&seen))));
    })?;
    let mut interrupted: Option<(PyErr, Instant)> = None;
    loop {
        let heard;
        (told, heard) = py.detach(move || {
            let heard = told.recv_timeout(PAUSE);
            (told, heard)
        });
        match heard {
            Ok(Ok(value)) => return Ok(Done { value, interrupted: interrupted.map(|(error, _)| error) }),
            Ok(Err(panic)) => return Err(internal(py, &*panic)),
            Err(RecvTimeoutError::Disconnected) => return Err(internal(py, &"the thread ended")),
            Err(RecvTimeoutError::Timeout) => match interrupted.take() {
                Some((error, since)) if since.elapsed() > GRACE => return Err(error),
                Some(earlier) => interrupted = Some(earlier),
                None => {
                    if let Err(error) = py.check_signals() {
                        flag.store(true, Ordering::Relaxed);
                        interrupted = Some((error, Instant::now()));
                    }
                }
            },
        }
    }
}

/// Does some short work here; a panic becomes an error of the package.
///
/// # Errors
/// That of the work, or a panic.
pub fn guarded<T>(py: Python<'_>, work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(internal(py, &*panic)))
}

fn internal(py: Python<'_>, panic: &(dyn Any + Send)) -> PyErr {
    let known = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = known.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    let error = exception(py, "InternalError").and_then(|class| class.call1((text,)));
    error.map_or_else(|error| error, PyErr::from_value)
}
