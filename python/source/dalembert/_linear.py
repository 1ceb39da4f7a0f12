"""Small motions: modes, and matrices for the design of controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

from ._results import Animation, Figure, Report

if TYPE_CHECKING:
    import control
    import pandas

_Array = NDArray[np.float64]


class Linear(Report):
    """M q'' + C q' + K q = F u + F_rates u' + F_accelerations u'' about an equilibrium, and x' = A x + B w, y = output_matrix x + feedthrough w.

    u are the `inputs`, which `in_` chose, w the `state_inputs`: u, and after each of its entries those of its rates that act; x = (q, q').
    All numbers are in SI units. Models with states of first order, and departures from a motion (`at_time`), have no M, C, K and F.
    """

    def _matrix(self, name: str) -> _Array:
        if name not in self.data:
            what = "a model with states of first order has" if self.time is None else "departures from a motion have"
            raise AttributeError(f"{what} no {name}: only A and B, and C and D of outputs")
        return _matrix(self.data[name])

    @property
    def M(self) -> _Array:
        """The mass matrix."""
        return self._matrix("M")

    @property
    def C(self) -> _Array:
        """Damping and gyroscopic forces."""
        return self._matrix("C")

    @property
    def K(self) -> _Array:
        """The stiffness matrix."""
        return self._matrix("K")

    @property
    def F(self) -> _Array:
        """What `inputs` do to the equations of motion, a column each."""
        return self._matrix("F")

    @property
    def F_rates(self) -> _Array:
        """What the rates of `inputs` do to them, a column each: the damper to a moved base."""
        return self._matrix("F_rates")

    @property
    def F_accelerations(self) -> _Array:
        """What the second rates of `inputs` do to them, a column each: the inertia of what a moved base carries."""
        return self._matrix("F_accelerations")

    @property
    def A(self) -> _Array:
        """The state matrix."""
        return _matrix(self.data["state"]["A"])

    @property
    def B(self) -> _Array:
        """What `state_inputs` do to the state, a column each."""
        return _matrix(self.data["state"]["B"])

    @property
    def output_matrix(self) -> _Array:
        """C of y = C x + D u, a row for each output; x itself where `out` named none."""
        state = self.data["state"]
        return _matrix(state["C"]) if "C" in state else np.eye(len(self.variables))

    @property
    def feedthrough(self) -> _Array:
        """D of y = C x + D u, a column for each of `state_inputs`."""
        state = self.data["state"]
        return _matrix(state["D"]) if "D" in state else np.zeros((len(self.variables), len(self.state_inputs)))

    @property
    def outputs(self) -> list[str]:
        """The names of y."""
        return self.data["state"].get("outputs", self.variables)

    @property
    def output_units(self) -> list[str]:
        """The units of y."""
        return self.data["state"].get("output_units", self.units)

    @property
    def state_inputs(self) -> list[str]:
        """The names of w, of columns of B: `inputs`, and after each those of its rates that act."""
        return self.data["state"]["inputs"]

    @property
    def coordinates(self) -> list[str]:
        """The names of q, independent coordinates where constraints act."""
        return self.data.get("coordinates", [])

    @property
    def variables(self) -> list[str]:
        """The names of x."""
        return self.data["state"]["variables"]

    @property
    def units(self) -> list[str]:
        """The units of x."""
        return self.data["state"]["units"]

    @property
    def inputs(self) -> list[str]:
        """The names of u, of columns of F, F_rates and F_accelerations: what `in_` named, all inputs of the model if it was not given."""
        return self.data["inputs"]

    @property
    def input_units(self) -> list[str]:
        """The units of u."""
        return self.data["input_units"]

    @property
    def equilibrium(self) -> dict[str, float]:
        """Where, about an equilibrium."""
        if "equilibrium" not in self.data:
            raise AttributeError("a motion is no equilibrium: `place` is the state at the instant `time`")
        return self.data["equilibrium"]

    @property
    def time(self) -> Optional[float]:
        """The instant of the motion, s, that `at_time` chose; None about an equilibrium."""
        return self.data.get("time")

    @property
    def place(self) -> dict[str, float]:
        """Where: the coordinates of the equilibrium, or the state at that instant."""
        return self.data["equilibrium"] if self.time is None else self.data["place"]

    def state_space(self) -> control.StateSpace:
        """A, B, C and D for python-control, with names, in which `_` stands for dots; every variable of x is an output where `out` named none.

        A system without inputs has one, `none`, that does nothing, where python-control needs it: of one state, or with one output.
        """
        import control

        kinds = {"states": self.variables, "outputs": self.outputs, "inputs": self.state_inputs}
        names = {kind: [name.replace(".", "_") for name in names] for kind, names in kinds.items()}
        B, D = self.B, self.feedthrough
        if not self.state_inputs and 1 in (len(B), len(D)):
            # python-control takes one row of nothing for a matrix without rows: an input that does nothing.
            B, D, names["inputs"] = np.zeros((len(B), 1)), np.zeros((len(D), 1)), ["none"]
        return control.ss(self.A, B, self.output_matrix, D, **names)


def _matrix(rows: list[list[float]]) -> _Array:
    """Rows of numbers, each of which may be empty."""
    return np.array(rows, dtype=float).reshape(len(rows), len(rows[0]) if rows else 0)


class Modes(Report):
    """What `modes --json` prints, and its pictures."""

    def __init__(self, text: str, again: Callable[..., str]):
        super().__init__(text)
        self._again = again

    @property
    def _modes(self) -> list[dict[str, Any]]:
        if "modes" not in self.data:
            raise AttributeError("there are eigenvalues of A here, but no modes of M, C and K: see `eigenvalues`")
        return self.data["modes"]

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """The eigenvalues, 1/s."""
        pairs = self.data["eigenvalues"] if "eigenvalues" in self.data else [m["eigenvalue"] for m in self._modes]
        return np.array([complex(*pair) for pair in pairs], dtype=complex)

    @property
    def omega(self) -> _Array:
        """Natural frequencies, rad/s."""
        return np.array([mode["omega"] for mode in self._modes])

    @property
    def hz(self) -> _Array:
        """The same in Hz."""
        return np.array([mode["hz"] for mode in self._modes])

    @property
    def zeta(self) -> _Array:
        """Damping ratios; NaN where a mode has none."""
        return np.array([np.nan if mode["zeta"] is None else mode["zeta"] for mode in self._modes])

    @property
    def shapes(self) -> NDArray[np.complex128]:
        """Mode shapes, a column each, in the file's coordinates."""
        return np.array([[complex(*x) for x in mode["shape"]] for mode in self._modes], dtype=complex).T

    def frame(self) -> pandas.DataFrame:
        """A row for each mode."""
        import pandas

        modes = self._modes
        columns = ["omega", "hz", "zeta", "kind"]
        frame = pandas.DataFrame([{name: mode[name] for name in columns} for mode in modes], columns=columns)
        frame.index = pandas.RangeIndex(1, len(modes) + 1, name="mode")
        return frame

    def shape_figure(self) -> Figure:
        """The shapes of all modes."""
        return Figure(self._again("plot", "shapes.svg"))

    def animation(self, mode: Optional[int] = None) -> Animation:
        """One mode in motion, by its number from 1; the first that is not rigid where none is given."""
        return Animation(self._again("animate", "mode.html", mode=mode))

    def _repr_html_(self) -> str:
        drawn = self.shape_figure().svg if "modes" in self.data else ""
        return drawn + (super()._repr_html_() or "")
