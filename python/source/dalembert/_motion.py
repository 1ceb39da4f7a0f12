"""A motion that was computed."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._dalembert import Run
from ._errors import UsageError
from ._options import Value, text_of
from ._results import Animation, Figure

if TYPE_CHECKING:
    import pandas

_Array = NDArray[np.float64]
#: All of a kind, none, one by its name, or several.
_Chosen = Union[bool, str, Sequence[str]]


def _listed(names: _Chosen) -> Optional[list[str]]:
    """None where nothing is wanted, an empty list where all is."""
    if isinstance(names, bool):
        return [] if names else None
    return [names] if isinstance(names, str) else list(names)


@dataclass(frozen=True)
class _Numbers:
    """What a run has at its reported times."""

    t: _Array
    states: _Array
    outputs: _Array
    json: str
    names: list[str]
    shown: list[str]
    units: dict[str, str]
    bounds: dict[str, Optional[_Array]]

    @staticmethod
    def of(run: Run) -> _Numbers:
        units = {name: run.unit(name) for name in run.names}
        bounds = {name: run.errors(name) for name in run.names}
        return _Numbers(*(np.array(rows) for rows in (run.t, run.states, run.outputs)), run.json, run.names, run.shown, units, bounds)

    def unit(self, name: str) -> str:
        return self.units[name]

    def errors(self, name: str) -> Optional[_Array]:
        return self.bounds[name]

    def __getattr__(self, name: str) -> Any:
        if name in ("at", "figure", "animation"):
            raise UsageError(f"`{name}` of a motion works where it was computed: only its numbers were pickled")
        raise AttributeError(name)


class Motion(Mapping[str, _Array]):
    """A motion: columns by name (`"theta1"`, `"theta1'"`, `"tip.x"`), and what tells how far it can be trusted.

    Arrays are views of the run's memory: nothing is copied, and nothing can be written. Pickled, as for other processes, it is its numbers at the
    reported times: what draws, and `at`, stay behind.
    """

    def __init__(self, run: Union[Run, _Numbers]):
        self._run = run
        states = run.states.shape[1]
        self._places = {name: place for place, name in enumerate(run.names)}
        self._shown = run.shown
        self._states = states
        self._mechanical = sum(not name.startswith("∫") for name in run.names[: states // 2])
        self.json: str = run.json
        self.data: dict[str, Any] = json.loads(run.json)

    @property
    def t(self) -> _Array:
        """The reported times, s."""
        return self._run.t

    @property
    def y(self) -> _Array:
        """The reported states row by row, coordinates before their rates."""
        return self._run.states

    @property
    def q(self) -> _Array:
        """The coordinates, a column each; in `y` hidden ones come after them, of which states of first order are the rates."""
        return self.y[:, : self._mechanical]

    @property
    def v(self) -> _Array:
        """Their rates, a column each; in `y` states of first order come after them."""
        half = self._states // 2
        return self.y[:, half : half + self._mechanical]

    @property
    def outputs(self) -> _Array:
        """The outputs, a column for each component; NaN where absent."""
        return self._run.outputs

    def __reduce__(self) -> tuple[Any, ...]:
        return Motion, (self._run if isinstance(self._run, _Numbers) else _Numbers.of(self._run),)

    def __getitem__(self, name: str) -> _Array:
        if name == "t":
            return self.t
        place = self._places[name]
        return self.y[:, place] if place < self._states else self.outputs[:, place - self._states]

    def __iter__(self) -> Iterator[str]:
        return iter(self._shown)

    def __len__(self) -> int:
        return len(self._shown)

    @property
    def end(self) -> dict[str, float]:
        """The last state with its outputs, by name."""
        return {name: float(self[name][-1]) for name in self}

    def unit(self, name: str) -> str:
        """The SI unit of a column; empty where it is a pure number."""
        return "s" if name == "t" else self._run.unit(self._known(name))

    @property
    def digits(self) -> Optional[dict[str, Optional[int]]]:
        """How many significant digits of each column hold at the end; None where that was not estimated."""
        return self.data["digits"]

    def errors(self, name: str) -> Optional[_Array]:
        """Bounds of a column's errors at the reported times; None where they were not estimated."""
        return self._run.errors(self._known(name))

    def _known(self, name: str) -> str:
        """The name of a column; a KeyError if there is none."""
        if name != "t" and name not in self._places:
            raise KeyError(name)
        return name

    @property
    def drift(self) -> dict[str, Optional[float]]:
        """By how much each conserved quantity drifts, and the energy balance."""
        return self.data["drift"]

    @property
    def warnings(self) -> list[str]:
        """What the user should know."""
        return self.data["warnings"]

    @property
    def events(self) -> list[dict[str, Any]]:
        """What happened, in order: `t` and `name`."""
        return self.data["events"]

    @property
    def method(self) -> str:
        """The method of integration."""
        return self.data["method"]

    def at(self, times: ArrayLike) -> _Array:
        """The states at any times of the motion by dense output, a row each, coordinates before their rates."""
        return self._run.at(np.atleast_1d(np.asarray(times, dtype=float)))

    def frame(self) -> pandas.DataFrame:
        """All columns as a frame of pandas, over time."""
        import pandas

        index = pandas.Index(self.t, name="t")
        return pandas.DataFrame({name: self[name] for name in self}, index=index)

    def figure(self, *shown: str, section: Optional[Value] = None) -> Figure:
        """Charts: `"theta1,theta2"` against time, `"theta1:theta2"` a portrait; with none those that a run has by itself.

        A section draws the points of portraits at multiples of a time only.
        """
        return Figure(self._run.figure(shown, None if section is None else text_of(section)))

    def animation(self, *columns: str, arrows: _Chosen = False, mark_events: _Chosen = False) -> Animation:
        """The mechanism in motion, with a chart of each of these columns beside it.

        `arrows` draws forces at the points where they act, `mark_events` writes names of events as they happen: `True` all of them, or a
        name, or a list of names.
        """
        return Animation(self._run.animation(columns, _listed(arrows), _listed(mark_events)))

    def _repr_html_(self) -> str:
        return f"{self.figure().svg}<pre>{html.escape(self._summary())}</pre>"

    def _summary(self) -> str:
        lines = [f"{self.data['model']} at t = {self.t[-1]:g}, by {self.method}"]
        lines += [f"  {name} = {value:.10g} {self.unit(name)}".rstrip() for name, value in self.end.items()]
        lines += [f"  drift of {name} {value:.1e}" for name, value in self.drift.items() if value is not None]
        if self.digits is not None:
            held = [digits for digits in self.digits.values() if digits is not None]
            lines += [f"  {min(held)} digits or more hold"] if held else []
        return "\n".join(lines + [f"  warning: {text}" for text in self.warnings])

    def __repr__(self) -> str:
        return f"<Motion of {self.data['model']}: {len(self.t)} states to t = {self.t[-1]:g}, by {self.method}>"
