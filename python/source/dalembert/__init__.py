"""Mechanisms described in YAML: derived, integrated, linearised, and judged.

>>> import dalembert
>>> pendulum = dalembert.load("double_pendulum")
>>> motion = pendulum.simulate(start={"theta1": 1.0}, until=5)
>>> motion["theta1"].shape
(501,)
"""

from ._compiled import Compiled
from ._dalembert import models
from ._equations import Equations
from ._errors import (
    CompileError,
    Error,
    EvaluationError,
    FileError,
    InternalError,
    Interrupted,
    ModelError,
    Problem,
    RunError,
    UsageError,
)
from ._linear import Linear, Modes
from ._mechanism import Mechanism, load
from ._motion import Motion
from ._results import Animation, Chart, Figure, Orbit, Report, Sweep

__all__ = [
    "Animation",
    "Chart",
    "CompileError",
    "Compiled",
    "Equations",
    "Error",
    "EvaluationError",
    "Figure",
    "FileError",
    "InternalError",
    "Interrupted",
    "Linear",
    "Mechanism",
    "ModelError",
    "Modes",
    "Motion",
    "Orbit",
    "Problem",
    "Report",
    "RunError",
    "Sweep",
    "UsageError",
    "load",
    "models",
]
