"""The equations of a mechanism as functions, for integrators and optimisers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _dalembert

if TYPE_CHECKING:
    from ._mechanism import Mechanism

_Array = NDArray[np.float64]


class Equations:
    """The equations of a scene: functions of a time t and a state y = (q, q') in SI units.

    The phase is that in which a run of the scene begins, unless another was asked for. Parameters, the phase and held values stay as they are;
    discontinuities are on the side where the state is. Nothing here keeps constraints, or does what events do: `simulate` does.
    """

    def __init__(
        self,
        native: _dalembert.Equations,
        names: list[str],
        events: list[tuple[str, int, bool, Optional[list[int]]]],
        again: tuple[Mechanism, dict[str, Any]],
    ):
        self._native = native
        self._again = again
        #: The names of y: coordinates, then their rates. A state z of first order is the rate of a hidden coordinate `∫z`, whose value nothing reads.
        self.names = names
        self._y0: Optional[_Array] = None
        #: From 0 to the scene's end, s.
        self.t_span = (0.0, native.until)
        #: The place of the phase among the mechanism's.
        self.phase = native.phase
        self._events = events
        #: The rate of the state, for `scipy.integrate.solve_ivp`.
        self.rhs: Callable[[float, ArrayLike], _Array] = native.rhs
        #: The slopes of the rate by the state, 2n by 2n, exact.
        self.jacobian: Callable[[float, ArrayLike], _Array] = native.jacobian
        #: M of M q'' + h = (J^T + B) lambda, n by n.
        self.mass_matrix: Callable[[float, ArrayLike], _Array] = native.mass_matrix
        #: h of the same.
        self.bias: Callable[[float, ArrayLike], _Array] = native.bias
        #: J of all rows of the constraints.
        self.constraint_matrix: Callable[[float, ArrayLike], _Array] = native.constraint_matrix
        #: How far each row of the constraints is missed, and its rate: two columns.
        self.constraints: Callable[[float, ArrayLike], _Array] = native.constraints
        #: lambda of all rows of the constraints; 0 of those that do not act.
        self.multipliers: Callable[[float, ArrayLike], _Array] = native.multipliers
        #: All outputs, component by component.
        self.outputs: Callable[[float, ArrayLike], _Array] = native.outputs
        #: Kinetic and potential energy, J.
        self.energy: Callable[[float, ArrayLike], tuple[float, float]] = native.energy
        #: The function of each event and its condition, two columns: it counts only where that is > 0.
        self.event_values: Callable[[float, ArrayLike], _Array] = native.events

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_again, self._again

    @property
    def y0(self) -> _Array:
        """The scene's start, on the constraints that act in the phase."""
        if self._y0 is None:
            self._y0 = self._native.start()
        return self._y0

    def events(self) -> list[Callable[[float, ArrayLike], float]]:
        """Functions of the events that count in this phase for `solve_ivp`, with `direction`; those that do more than record are `terminal`.

        Where the condition of an event is not > 0, its function is not a number, which `solve_ivp` takes for no passage through zero.
        """
        here = [phases is None or self.phase in phases for _, _, _, phases in self._events]
        return [self._event(place, *self._events[place][:3]) for place, counts in enumerate(here) if counts]

    def _event(self, place: int, name: str, direction: int, acts: bool) -> Callable[[float, ArrayLike], float]:
        values = self.event_values

        def event(t: float, y: ArrayLike) -> float:
            function, condition = values(t, y)[place]
            return float(function) if condition > 0 else float("nan")

        event.__name__ = name
        event.terminal = acts  # type: ignore[attr-defined]
        event.direction = direction  # type: ignore[attr-defined]
        return event


def _made_again(mechanism: Mechanism, asked: dict[str, Any]) -> Equations:
    return mechanism.equations(**asked)
