"""What can go wrong."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from ._dalembert import Run
    from ._motion import Motion


class Error(Exception):
    """Every error of this package."""


class UsageError(Error, ValueError):
    """An option, a name or a value that is not known."""


class FileError(Error, OSError):
    """A file that cannot be read or written."""


class EvaluationError(Error, ArithmeticError):
    """Equations that have no value at a state, as where the mass matrix is singular."""


class CompileError(Error, RuntimeError):
    """C that cannot be compiled here, or whose results differ."""


class InternalError(Error, RuntimeError):
    """A defect of the library: please report it."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a model file; lines and columns count from 1."""

    code: str
    severity: str
    text: str
    help: str
    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}: {self.severity}[{self.code}]: {self.text}"


def problems(text: str, path: str) -> tuple[Problem, ...]:
    """The problems that `check --json` lists."""
    return tuple(
        Problem(
            one["code"],
            one["severity"],
            one["message"],
            one["help"],
            path,
            one["line"],
            one["column"],
            one["end_line"],
            one["end_column"],
        )
        for one in json.loads(text)
    )


class ModelError(Error, ValueError):
    """A model file with mistakes; `problems` holds all of them."""

    problems: tuple[Problem, ...]

    def __init__(self, text: str, path: str = "", listed: str = "[]"):
        super().__init__(text)
        self.problems = problems(listed, path)


class RunError(Error, RuntimeError):
    """A run or a search that failed.

    Of a run `time` says when, `state` in which state, and `motion` is all that was computed; of a search these are None.
    """

    def __init__(self, text: str, motion: Optional[Motion] = None, time: Optional[float] = None):
        super().__init__(text)
        self.motion = motion
        self.time = time
        self.state = motion.end if motion is not None else None


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `motion` is what was computed until then."""

    def __init__(self, motion: Motion):
        super().__init__("interrupted")
        self.motion = motion


def failed(text: str, run: Run, time: float) -> RunError:
    """The error of a run that failed."""
    from ._motion import Motion

    return RunError(text, Motion(run), time)


def interrupted(run: Run) -> Interrupted:
    """The exception of a run that was interrupted."""
    from ._motion import Motion

    return Interrupted(Motion(run))
