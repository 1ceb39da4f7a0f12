"""A mechanism's equations as C, compiled here."""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import CompileError, EvaluationError
from ._options import Values, options

if TYPE_CHECKING:
    from ._equations import Equations
    from ._mechanism import Mechanism

_Array = NDArray[np.float64]

#: No sum of products is rounded once where the interpreter rounds twice.
_FLAGS = ["-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off"]
#: Compiled and interpreted accelerations that differ by more than this part of the largest are not the same.
_SAME = 1e-12
#: States at which they are compared, beside the start.
_STATES = 8


class Compiled:
    """Compiled equations of a scene: functions of a time t and a state y = (q, q') in SI units, as those of `Equations`."""

    def __init__(self, library: Path, prefix: str, sizes: dict[str, int], equations: Equations, kept: Any):
        #: Where the C and the library are.
        self.folder = library.parent
        #: The shared library, whose functions NAME.h declares; its name has a part that other equations do not share.
        self.library = library
        #: By how much accelerations differ from the interpreted ones, as a part of the largest; 0: they have the same bits.
        self.difference = 0.0
        self._kept = kept
        self._sizes = sizes
        self._functions = ctypes.CDLL(str(self.library))
        self._prefix = prefix
        self._constants = np.zeros(max(sizes["CONSTANTS"], 1))
        self._call("constants", np.array(equations._native.parameters + [0.0]), self._constants)
        if sizes["MEMORY"] > 0:
            held = self._functions[f"{prefix}_memory"]
            held.restype = ctypes.POINTER(ctypes.c_double)
            np.ctypeslib.as_array(held(_passed(self._constants)), (sizes["MEMORY"],))[:] = equations._native.memory
        if sizes["PHASES"] > 0:
            self._call("set_phase", self._constants, equations.phase)

    def rhs(self, t: float, y: ArrayLike) -> _Array:
        """The rate (q', q'') of a state."""
        t, c, u, q, v = self._at(t, y)
        rate = np.empty(2 * len(q))
        rate[: len(q)] = v
        self._accelerations(c, t, u, q, v, rate[len(q) :])
        return rate

    def mass_matrix(self, t: float, y: ArrayLike) -> _Array:
        """The mass matrix M."""
        t, c, u, q, v = self._at(t, y)
        matrix = np.zeros((len(q), len(q)))
        self._call("mass_matrix", c, t, u, q, v, matrix)
        return matrix

    def bias(self, t: float, y: ArrayLike) -> _Array:
        """h of M q'' + h."""
        t, c, u, q, v = self._at(t, y)
        h = np.zeros(len(q))
        self._call("bias", c, t, u, q, v, h)
        return h

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("compiled equations stay in their process: pickle the mechanism, and compile it in the other one")

    def _at(self, t: float, y: ArrayLike) -> tuple[float, _Array, _Array, _Array, _Array]:
        """The time, the block of constants with the sides of discontinuities, inputs, coordinates and rates."""
        t, n = float(t), self._sizes["COORDINATES"]
        y = np.ascontiguousarray(y, dtype=float)
        if y.shape != (2 * n,):
            raise ValueError(f"a state has {2 * n} numbers, not {y.size}")
        c, u, q, v = self._constants, np.zeros(3 * self._sizes["INPUTS"]), y[:n], y[n:]
        self._call("inputs", c, t, u)
        if self._sizes["MODES"] > 0:
            c = c.copy()
            a, multipliers = np.zeros(n), np.zeros(self._sizes["ROWS"])
            # An input may have sides, and those of others depend on it.
            for _ in range(2):
                self._call("accelerations", c, t, u, q, v, a, multipliers)
                self._call("settle", c, t, u, q, v, a, multipliers)
                self._call("inputs", c, t, u)
        return t, c, u, q, v

    def _accelerations(self, c: _Array, t: float, u: _Array, q: _Array, v: _Array, a: _Array) -> None:
        multipliers = np.zeros(self._sizes["ROWS"])
        failed = self._call("accelerations", c, t, u, q, v, a, multipliers)
        if failed:
            what = f"the inertia of coordinate {failed - 1} vanishes" if failed > 0 else f"row {-1 - failed} has no reaction"
            raise EvaluationError(f"{what} at t = {t}")

    def _call(self, name: str, *arguments: Any) -> int:
        function = getattr(self._functions, f"{self._prefix}_{name}")
        return function(*[_passed(argument) for argument in arguments])

    def __repr__(self) -> str:
        return f"<Compiled: {self.library}, difference {self.difference:.1e}>"


def _passed(argument: Any) -> Any:
    if isinstance(argument, np.ndarray):
        return ctypes.c_void_p(argument.ctypes.data)
    return ctypes.c_double(argument) if isinstance(argument, float) else ctypes.c_int(argument)


def build(
    mechanism: Mechanism,
    folder: Union[None, str, os.PathLike[str]],
    scene: Optional[str],
    set: Optional[Values],
    compiler: Optional[str],
) -> Compiled:
    """Writes, compiles, loads and compares."""
    command = _compiler(compiler)
    kept = tempfile.TemporaryDirectory() if folder is None else None
    place = Path(kept.name if kept is not None else os.fspath(folder or "."))
    prefix = _prefix(mechanism._answer("export", options(c=place)))
    header = place / f"{prefix}.h"
    pattern = rf"^    {prefix.upper()}_([A-Z]+) = (\d+),"
    sizes = {name: int(size) for name, size in re.findall(pattern, header.read_text(encoding="utf-8"), re.MULTILINE)}
    library = _library(place, prefix, command)
    equations = mechanism.equations(scene, set=set)
    compiled = Compiled(library, prefix, sizes, equations, kept)
    compiled.difference = _difference(compiled, equations)
    if not compiled.difference <= _SAME:
        raise CompileError(f"compiled accelerations differ from interpreted ones by {compiled.difference:.1e} of the largest")
    return compiled


def _library(place: Path, prefix: str, command: list[str]) -> Path:
    """Compiles, and removes the library of what stood in the folder before.

    A process that has loaded a library is given it again under its path, whatever is there by then: other code has another path.
    """
    line = [*command, *_FLAGS]
    digest = hashlib.sha256("\0".join(line).encode())
    for name in (f"{prefix}.h", f"{prefix}.c", "dalembert_core.h", "dalembert_core.c"):
        digest.update((place / name).read_bytes())
    library = place / f"{prefix}-{digest.hexdigest()[:16]}.so"
    sources = [str(place / name) for name in (f"{prefix}.c", "dalembert_core.c")]
    with tempfile.TemporaryDirectory(dir=place) as beside:
        made = Path(beside, library.name)
        done = subprocess.run([*line, "-o", str(made), *sources, "-lm"], capture_output=True, text=True)
        if done.returncode != 0:
            raise CompileError(f"{' '.join(command)} failed:\n{done.stderr}")
        made.replace(library)
    for other in place.iterdir():
        if other != library and re.fullmatch(rf"{prefix}-[0-9a-f]{{16}}\.so", other.name):
            other.unlink()
    return library


def _prefix(told: str) -> str:
    """Of `wrote NAME.h, …` the name."""
    return told.split(".h", 1)[0].rsplit(" ", 1)[-1]


def _compiler(asked: Optional[str]) -> list[str]:
    command = shlex.split(asked or os.environ.get("CC", ""))
    names = command[:1] or ["cc", "gcc", "clang"]
    found = next((path for path in map(shutil.which, names) if path), None)
    if found is None:
        raise CompileError(f"there is no C compiler here ({', '.join(names)}); `equations` needs none")
    return [found, *command[1:]]


def _difference(compiled: Compiled, equations: Equations) -> float:
    """The largest difference of rates at the start and at states about it, as a part of the largest."""
    random = np.random.default_rng(1)
    worst = 0.0
    for place in range(1 + _STATES):
        t = equations.t_span[1] * place / (1 + _STATES)
        y = equations.y0 + (0.3 * random.standard_normal(len(equations.y0)) if place else 0.0)
        try:
            interpreted = equations.rhs(t, y)
        except EvaluationError:
            continue
        scale = np.max(np.abs(interpreted), initial=np.finfo(float).tiny)
        worst = max(worst, float(np.max(np.abs(compiled.rhs(t, y) - interpreted), initial=0.0) / scale))
    return worst
