//! Ctrl-C and SIGTERM.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Once};

#[cfg(unix)]
use signal_hook::consts::{SIGINT, SIGTERM};

#[cfg(unix)]
use super::{Problem, json};

/// Set by the first signal.
static ASKED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Whether a command looks whether it is set, since it has something to keep.
static AWAITED: AtomicBool = AtomicBool::new(false);
/// Whether the command prints one object whatever happens.
static AS_JSON: AtomicBool = AtomicBool::new(false);
/// Whether it has begun to.
static PRINTED: AtomicBool = AtomicBool::new(false);

/// From now on a signal ends the program, unless a command waits for it; where it prints JSON, with an object that says so.
pub fn listen(as_json: bool) {
    AS_JSON.store(as_json, Ordering::Relaxed);
    static LISTENING: Once = Once::new();
    LISTENING.call_once(start);
}

/// True from the first signal on; a second one ends the program.
pub fn awaited() -> Arc<AtomicBool> {
    listen(AS_JSON.load(Ordering::Relaxed));
    AWAITED.store(true, Ordering::SeqCst);
    #[cfg(not(any(unix, target_family = "wasm")))]
    by_flags();
    ASKED.clone()
}

/// Whatever ends the program from now on, its output has begun.
pub fn printing() {
    PRINTED.store(true, Ordering::SeqCst);
}

/// Where signals cannot be had, they end the program as they always did.
#[cfg(unix)]
fn start() {
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            let first = !ASKED.swap(true, Ordering::SeqCst);
            if !(first && AWAITED.load(Ordering::SeqCst)) {
                end(signal);
            }
        }
    });
}

#[cfg(unix)]
fn end(signal: i32) {
    let problem = Problem::Run("interrupted".to_owned());
    if AS_JSON.load(Ordering::Relaxed) && !PRINTED.swap(true, Ordering::SeqCst) {
        // Nobody may read any more.
        _ = json::write(&json::object([("error", problem.as_json())]), &mut std::io::stdout());
    }
    eprintln!("{problem}");
    std::process::exit(128 + signal);
}

/// Elsewhere no thread can wait for signals: until a command does, they end the program as they always did.
#[cfg(not(unix))]
fn start() {}

/// The first signal sets the flag, a second one ends the program.
#[cfg(not(any(unix, target_family = "wasm")))]
fn by_flags() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    for signal in [SIGINT, SIGTERM] {
        let again = Arc::new(AtomicBool::new(false));
        _ = signal_hook::flag::register(signal, ASKED.clone());
        _ = signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, again.clone());
        _ = signal_hook::flag::register(signal, again);
    }
}
