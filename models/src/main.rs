//! The program `dalembert`.

use std::process::ExitCode;

fn main() -> ExitCode {
    dalembert::cli::main(dalembert_models::MODELS)
}
