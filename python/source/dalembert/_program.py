"""The program `dalembert`."""

import signal
import sys

from ._dalembert import program


def main() -> int:
    """Runs the program with the process's arguments."""
    # Ctrl-C is the program's own: its first one ends a run and writes what was computed.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.stdout.flush()
    return program(["dalembert", *sys.argv[1:]])
