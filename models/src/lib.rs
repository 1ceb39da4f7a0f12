//! The library of mechanisms: every model file of this folder, compiled, each in a module of its own.

use dalembert::cli::Entry;
use dalembert::mechanism::Erased;

include!(concat!(env!("OUT_DIR"), "/models.rs"));
