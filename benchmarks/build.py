#!/usr/bin/env python3
"""CPU seconds of all compilers for a first command, a stranger's crate, checked-in code, a release and an edit.

Run in the project: `python3 benchmarks/build.py`.  Each is built from a clone, in an empty target directory, with sources of packages that are there
already; the time is that of all processes that the build starts (user and system), the wall clock beside it.
"""

import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

PROJECT = pathlib.Path(__file__).resolve().parent.parent
MANIFEST = """[package]
name = "stranger"
version = "0.1.0"
edition = "2024"
[dependencies]
dalembert = {{ path = "{clone}/runtime"{features} }}
[workspace]
"""
MAIN = """use dalembert::prelude::*;
dalembert::model!("pendulum.yaml");
fn main() -> Result<(), dalembert::Error> {
    println!("{}", Pendulum::default().simulate().run()?.last());
    Ok(())
}
"""
PENDULUM = """name: Pendulum
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: "l*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
scene: {start: {theta: 1}, until: 10}
"""


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measured(what, command, folder, target):
    """Prints a row of the table."""
    before, start = cpu(), time.monotonic()
    done = subprocess.run(command, cwd=folder, env={**os.environ, "CARGO_TARGET_DIR": str(target)}, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{what}: {done.stderr}")
    print(f"| {what} | {cpu() - before:.0f} | {time.monotonic() - start:.0f} |", flush=True)


def main():
    home = pathlib.Path(tempfile.mkdtemp(prefix="dalembert-build-"))
    clone = home / "clone"
    subprocess.run(["git", "clone", "-q", PROJECT, clone], check=True)
    crate = home / "stranger"
    (crate / "src").mkdir(parents=True)
    (crate / "Cargo.toml").write_text(MANIFEST.format(clone=clone, features=""))
    (crate / "src/main.rs").write_text(MAIN)
    (crate / "pendulum.yaml").write_text(PENDULUM)
    # What is to be had from a registry is no compiler's work.
    for folder in (clone, crate, clone / "tests/outside-checked"):
        subprocess.run(["cargo", "fetch", "-q"], cwd=folder, check=True)
    print("| what | CPU, s | wall, s |\n| --- | ---: | ---: |")
    first = ["cargo", "run", "-q", "--", "simulate", "double_pendulum"]
    measured("first command (`cargo run -- simulate double_pendulum`)", first, clone, home / "first")
    measured("a crate with one `model!`, debug", ["cargo", "build", "-q"], crate, home / "crate")
    (crate / "pendulum.yaml").write_text(PENDULUM.replace("theta: 1}", "theta: 2}"))
    measured("the same after its model was edited", ["cargo", "build", "-q"], crate, home / "crate")
    measured("a crate with one `model!`, release", ["cargo", "build", "-q", "--release"], crate, home / "crate-release")
    measured("a crate with checked-in code, debug", ["cargo", "build", "-q"], clone / "tests/outside-checked", home / "checked")
    measured("the program in release", ["cargo", "build", "-q", "--release"], clone, home / "release")
    shutil.rmtree(home)


if __name__ == "__main__":
    main()
