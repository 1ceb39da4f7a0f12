"""What tests share."""

import pathlib
import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def program():
    """Runs the installed program; returns what it writes to standard output."""
    path = pathlib.Path(sys.executable).with_name("dalembert")

    def run(*arguments, status=0):
        done = subprocess.run([path, *arguments], capture_output=True, text=True)
        assert done.returncode == status, done.stderr
        return done.stdout

    return run
