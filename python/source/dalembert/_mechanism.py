"""A mechanism, and what can be asked of it."""

from __future__ import annotations

import csv
import difflib
import functools
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _dalembert, _errors
from ._compiled import Compiled, build
from ._equations import Equations
from ._linear import Linear, Modes
from ._motion import Motion
from ._options import Value, Values, options
from ._results import Chart, Figure, Orbit, Report, Sweep

_Path = Union[str, "os.PathLike[str]"]
_Names = Union[str, Sequence[str]]


def load(source: _Path, *, name: Optional[str] = None, sizes: Optional[Mapping[str, int]] = None) -> Mechanism:
    """Loads a model: by its name in the library (`models()` lists them), by the path of its file, or from its text.

    What has several lines, or braces, is a text; it goes by `name`, else by the name that it states. `sizes` are other sizes than the
    file's. Of a model with mistakes a `ModelError` holds all of them.
    """
    listed = list((sizes or {}).items())
    if isinstance(source, str) and ("\n" in source or "{" in source):
        stated = _dalembert.stated_name(source) or ""
        name = name or (stated if stated.isidentifier() else "model")
        return Mechanism(_dalembert.Model.of_text(name, source, listed))
    return Mechanism(_dalembert.Model.named(os.fspath(source), listed))


class Mechanism:
    """A model that was derived; all numbers are in SI units.

    Keyword arguments are the options of the program: `set` gives values of parameters, `start` those of coordinates and rates
    (`{"theta": "30 deg", "theta'": 1}`), `until` says where a run ends. A value is a number, or an expression of the model language.

    It never changes. Pickled, as for other processes, it is its text with those of its tables, from which it is derived again.
    """

    def __init__(self, model: _dalembert.Model):
        self._model = model
        self._own: Optional[Equations] = None

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._model.kept,)

    def __copy__(self) -> Mechanism:
        return self

    def __deepcopy__(self, _: Any) -> Mechanism:
        return self

    def __repr__(self) -> str:
        return f"<Mechanism {self.name}: {', '.join(self.coordinates)}>"

    @property
    def name(self) -> str:
        """The name that it goes by: its file's."""
        return self._model.name

    @property
    def source(self) -> str:
        """The model file's text."""
        return self._model.source

    @property
    def about(self) -> str:
        """The model file's own words."""
        return self._model.about

    @property
    def warnings(self) -> tuple[_errors.Problem, ...]:
        """What the user should know of the file."""
        return _errors.problems(self._model.warnings, self.name)

    @property
    def coordinates(self) -> dict[str, str]:
        """The generalized coordinates with their units."""
        return {name: unit for name, unit in self._model.coordinates if not name.startswith("∫")}

    @property
    def states(self) -> dict[str, str]:
        """The states of first order with their units."""
        return {name[1:]: unit for name, unit in self._model.coordinates if name.startswith("∫")}

    @property
    def parameters(self) -> dict[str, float]:
        """The free parameters with the file's values."""
        return {name: value for name, _, value in self._model.parameters}

    @property
    def parameter_units(self) -> dict[str, str]:
        """The units of the free parameters."""
        return {name: unit for name, unit, _ in self._model.parameters}

    @property
    def inputs(self) -> list[str]:
        """The names of the inputs."""
        return self._model.inputs

    @property
    def outputs(self) -> dict[str, str]:
        """The outputs with their units."""
        return {name: unit for name, _, unit in self._model.outputs}

    @property
    def scenes(self) -> list[str]:
        """The names of the scenes; the first is the default."""
        return self._model.scenes

    @property
    def phases(self) -> list[str]:
        """The names of the phases; one without a name where the file has none."""
        return self._model.phases

    @property
    def constraints(self) -> list[str]:
        """The names of the rows of the constraints."""
        return self._model.constraints

    def simulate(
        self,
        scene: Optional[str] = None,
        *,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        input: Optional[Values] = None,
        until: Optional[Value] = None,
        tolerance: Optional[float] = None,
        every: Optional[Value] = None,
        method: Optional[str] = None,
        step: Optional[Value] = None,
        max_steps: Optional[int] = None,
        digits: Optional[bool] = None,
        by: Optional[str] = None,
        slopes: Optional[_Names] = None,
        ignore: Optional[_Names] = None,
        together: bool = False,
        constraints: Optional[str] = None,
        stiffness: Optional[float] = None,
        damping: Optional[float] = None,
        drift: Optional[str] = None,
        alpha: Optional[float] = None,
        params: Optional[_Path] = None,
        state: Optional[_Path] = None,
        save: Optional[_Path] = None,
    ) -> Motion:
        """Runs a scene.

        `save` names a file for the final state (.yaml, .yml, .txt), from which `state` starts. `digits` says whether a second run tells how many digits hold; by default it does after a run that took less than 10 s. A run that
        fails raises a `RunError`, with all that was computed.
        """
        given = options(
            scene=scene,
            set=set,
            start=start,
            input=input,
            until=until,
            tolerance=tolerance,
            every=every,
            method=method,
            step=step,
            max_steps=max_steps,
            digits=digits,
            no_digits=digits is False,
            by=by,
            slopes=slopes,
            ignore=ignore,
            together=together,
            constraints=constraints,
            stiffness=stiffness,
            damping=damping,
            drift=drift,
            alpha=alpha,
            params=params,
            state=state,
            save=save,
        )
        return Motion(self._model.simulate(given))

    def modes(
        self,
        scene: Optional[str] = None,
        *,
        set: Optional[Values] = None,
        at: Optional[Values] = None,
        hold: Optional[Values] = None,
        solve: Optional[_Names] = None,
        input: Optional[Values] = None,
        phase: Optional[str] = None,
        sampled: bool = False,
        steady: bool = False,
        here: bool = False,
        at_time: Optional[Value] = None,
        drive: Optional[_Names] = None,
        omega: Optional[Value] = None,
        response: Optional[_Names] = None,
        range: Optional[str] = None,
        vary: Optional[Mapping[str, str]] = None,
        params: Optional[_Path] = None,
    ) -> Modes:
        """Finds an equilibrium, from `at` or the file's guess, and the modes of small motions about it.

        `hold` and `solve` trim: inputs, parameters or held values are found with which what is held rests where it is said to be.
        `at_time` asks for small departures from the scene's motion instead, as they are then: `eigenvalues` and `["A"]`, but no modes.
        """
        given = options(
            scene=scene,
            set=set,
            at=at,
            hold=hold,
            solve=solve,
            input=input,
            phase=phase,
            sampled=sampled,
            steady=steady,
            here=here,
            at_time=at_time,
            drive=drive,
            omega=omega,
            response=response,
            range=range,
            vary=vary,
            params=params,
        )
        return Modes(self._answer("modes", given + ["--json"]), functools.partial(_drawn_modes, self, given))

    def linearise(
        self,
        scene: Optional[str] = None,
        *,
        set: Optional[Values] = None,
        at: Optional[Values] = None,
        hold: Optional[Values] = None,
        solve: Optional[_Names] = None,
        input: Optional[Values] = None,
        phase: Optional[str] = None,
        steady: bool = False,
        here: bool = False,
        at_time: Optional[Value] = None,
        in_: Optional[_Names] = None,
        out: Optional[_Names] = None,
        params: Optional[_Path] = None,
    ) -> Linear:
        """Finds an equilibrium as `modes` does, and gives the matrices there: of M q'' + C q' + K q = F u + F_rates u' + F_accelerations u'', and
        of x' = A x + B w, where w are u and those of its rates that act.

        `out` names outputs (coordinates, rates, states, outputs), of which `output_matrix` and `feedthrough` are C and D of y = C x + D w; `in_` names
        what u is: inputs, entries of `forces` or `torques`, coordinates that a force acts on; all inputs if not given.
        `at_time` asks for small departures from the scene's motion instead, as they are then.
        """
        given = options(
            scene=scene,
            set=set,
            at=at,
            hold=hold,
            solve=solve,
            input=input,
            phase=phase,
            steady=steady,
            here=here,
            at_time=at_time,
            in_=in_,
            out=out,
            params=params,
        )
        return Linear(self._model.linearise(given))

    def sweep(
        self,
        vary: Optional[Mapping[str, Union[str, ArrayLike]]] = None,
        *,
        points: Union[None, _Path, Mapping[str, ArrayLike]] = None,
        seeds: Optional[str] = None,
        scene: Optional[str] = None,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        input: Optional[Values] = None,
        until: Optional[Value] = None,
        tolerance: Optional[float] = None,
        every: Optional[Value] = None,
        method: Optional[str] = None,
        step: Optional[Value] = None,
        max_steps: Optional[int] = None,
        modes: Optional[int] = None,
        show: Optional[_Names] = None,
        threads: Optional[int] = None,
        shard: Optional[str] = None,
        params: Optional[_Path] = None,
    ) -> Sweep:
        """Runs a scene many times in threads.

        `vary` gives values by name (`{"l": numpy.linspace(0.5, 2, 100)}`, or `"0.5..2:100"`); several make a grid. `points` gives the
        values of all runs instead: columns of one length (a mapping or a frame), or a file. `seeds` are those of noise, `"1..100"`. Runs that fail are rows too, with an error.
        """
        with tempfile.TemporaryDirectory() as folder:
            given = options(
                vary=vary,
                points=_table(points, folder),
                seeds=seeds,
                scene=scene,
                set=set,
                start=start,
                input=input,
                until=until,
                tolerance=tolerance,
                every=every,
                method=method,
                step=step,
                max_steps=max_steps,
                modes=modes,
                show=show,
                threads=threads,
                shard=shard,
                params=params,
                csv="-",
                quiet=True,
            )
            plot = Path(folder, "sweep.svg")
            text, problem = self._model.command("sweep", [*given, f"--plot={plot}"])
            if not text:
                raise _error(problem)
            return Sweep(text, Figure(plot.read_text(encoding="utf-8")))

    def chart(
        self,
        scene: Optional[str] = None,
        *,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        input: Optional[Values] = None,
        until: Optional[Value] = None,
        steps: bool = False,
        returns: Optional[int] = None,
        motion: Optional[str] = None,
        state: Optional[_Path] = None,
        methods: Optional[_Names] = None,
        compare: Optional[_Names] = None,
        twin: Optional[str] = None,
        needs: Optional[_Names] = None,
        within: Optional[float] = None,
        max_steps: Optional[int] = None,
        params: Optional[_Path] = None,
    ) -> Chart:
        """Charts speed against accuracy: what every method that suits costs for its error.

        With `steps` errors against step sizes; with `returns` how far methods miss the start of a motion that repeats, for so many periods: the
        motion that `orbit` finds from the scene, from a `state` file or by the name `motion`.
        """
        given = options(
            scene=scene,
            set=set,
            start=start,
            input=input,
            until=until,
            steps=steps,
            returns=returns,
            motion=motion,
            state=state,
            methods=methods,
            compare=compare,
            twin=twin,
            needs=needs,
            within=within,
            max_steps=max_steps,
            params=params,
        )
        with tempfile.TemporaryDirectory() as folder:
            points = Path(folder, "points.csv")
            text, svg = self._drawn("chart", [*given, f"--csv={points}"], "plot", "chart.svg")
            # Where its files went is of no use any more.
            text = "".join(line for line in text.splitlines(True) if not line.startswith("written: "))
            return Chart(text, points.read_text(encoding="utf-8"), Figure(svg))

    def needs(
        self,
        scene: Optional[str] = None,
        *,
        needs: Optional[_Names] = None,
        within: Optional[float] = None,
        all: bool = False,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        until: Optional[Value] = None,
        max_steps: Optional[int] = None,
        write: Optional[_Path] = None,
        params: Optional[_Path] = None,
    ) -> Report:
        """Tells what a scene can do without; `write` names the file of the smaller model."""
        given = options(
            scene=scene,
            needs=needs,
            within=within,
            all=all,
            set=set,
            start=start,
            until=until,
            max_steps=max_steps,
            write=write,
            params=params,
            json=True,
        )
        text, svg = self._drawn("needs", given, "plot", "needs.svg")
        return Report(text, Figure(svg))

    def check(self) -> Report:
        """What was tested when the equations were derived, and how well it held."""
        return Report(self._answer("check", ["--json"]))

    def orbit(
        self,
        scene: Optional[str] = None,
        *,
        motion: Optional[str] = None,
        period: Optional[Value] = None,
        part: Optional[int] = None,
        at: Optional[str] = None,
        count: Optional[int] = None,
        exchange: Optional[Mapping[str, str]] = None,
        mirror: Optional[_Names] = None,
        shift: Optional[_Names] = None,
        turn: Optional[Mapping[str, int]] = None,
        from_: Optional[str] = None,
        amplitude: Optional[Value] = None,
        energy: Optional[Value] = None,
        vary: Optional[Mapping[str, str]] = None,
        branch: Optional[int] = None,
        here: bool = False,
        map: Optional[Mapping[str, str]] = None,
        segments: Optional[int] = None,
        double_double: bool = False,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        input: Optional[Values] = None,
        until: Optional[Value] = None,
        tolerance: Optional[float] = None,
        method: Optional[str] = None,
        max_steps: Optional[int] = None,
        params: Optional[_Path] = None,
        state: Optional[_Path] = None,
        save: Optional[_Path] = None,
    ) -> Orbit:
        """Finds a motion that repeats, with its period and multipliers; with `vary` a family of them, with `map` its stability."""
        given = options(
            scene=scene,
            motion=motion,
            period=period,
            part=part,
            at=at,
            count=count,
            exchange=exchange,
            mirror=mirror,
            shift=shift,
            turn=turn,
            from_=from_,
            amplitude=amplitude,
            energy=energy,
            vary=vary,
            branch=branch,
            here=here,
            map=map,
            segments=segments,
            double_double=double_double,
            set=set,
            start=start,
            input=input,
            until=until,
            tolerance=tolerance,
            method=method,
            max_steps=max_steps,
            params=params,
            state=state,
            save=save,
            json=True,
        )
        text, svg = self._drawn("orbit", given, "plot", "orbit.svg")
        return Orbit(text, Figure(svg))

    def solve(
        self,
        unknown: Optional[Values] = None,
        *,
        such_that: Optional[Values] = None,
        maximise: Optional[str] = None,
        minimise: Optional[str] = None,
        fit: Union[None, _Path, Mapping[str, ArrayLike]] = None,
        columns: Optional[Mapping[str, str]] = None,
        motion: Optional[str] = None,
        scene: Optional[str] = None,
        set: Optional[Values] = None,
        start: Optional[Values] = None,
        input: Optional[Values] = None,
        until: Optional[Value] = None,
        tolerance: Optional[float] = None,
        ignore: Optional[_Names] = None,
        method: Optional[str] = None,
        max_steps: Optional[int] = None,
        params: Optional[_Path] = None,
        state: Optional[_Path] = None,
        save: Optional[_Path] = None,
    ) -> Report:
        """Finds starts, parameters and end times for which a motion does what is wanted.

        `unknown` gives what is unknown with a guess of each. `fit` is the record that the motion is to follow: columns of one length, of which
        one is `t` (a mapping or a frame), or a file.
        """
        with tempfile.TemporaryDirectory() as folder:
            given = options(
                unknown=unknown,
                such_that=such_that,
                maximise=maximise,
                minimise=minimise,
                fit=_table(fit, folder),
                columns=columns,
                motion=motion,
                scene=scene,
                set=set,
                start=start,
                input=input,
                until=until,
                tolerance=tolerance,
                ignore=ignore,
                method=method,
                max_steps=max_steps,
                params=params,
                state=state,
                save=save,
                json=True,
            )
            text, svg = self._drawn("solve", given, "plot", "solve.svg")
            return Report(text, Figure(svg))

    def equations(
        self,
        scene: Optional[str] = None,
        *,
        set: Optional[Values] = None,
        phase: Optional[str] = None,
        by: Optional[str] = None,
    ) -> Equations:
        """The equations of a scene as functions of time and state, with other values of parameters.

        The phase is that in which a run begins, by what its start decides of contacts and friction, if `phase` names no other.
        `by` names a system of `balances` from which the accelerations come.
        """
        mode = None if phase is None else _place("phase", phase, self.phases)
        system = None if by is None else _place("system of balances", by, self._model.derivations)
        native = self._model.equations(options(scene=scene, set=set), mode, system)
        coordinates = [name for name, _ in self._model.coordinates]
        rates = [name[1:] if name.startswith("∫") else f"{name}'" for name in coordinates]
        again = (self, {"scene": scene, "set": dict(set or {}), "phase": phase, "by": by})
        return Equations(native, coordinates + rates, self._model.events, again)

    @property
    def _equations(self) -> Equations:
        if self._own is None:
            self._own = self.equations()
        return self._own

    def rhs(self, t: float, y: ArrayLike) -> NDArray[np.float64]:
        """The rate (q', q'') of a state y = (q, q'), with the first scene's parameters; `equations` takes others."""
        return self._equations.rhs(t, y)

    def jacobian(self, t: float, y: ArrayLike) -> NDArray[np.float64]:
        """The slopes of the rate by the state, exact."""
        return self._equations.jacobian(t, y)

    def mass_matrix(self, t: float, y: ArrayLike) -> NDArray[np.float64]:
        """The mass matrix M."""
        return self._equations.mass_matrix(t, y)

    def compile(
        self,
        folder: Optional[_Path] = None,
        *,
        scene: Optional[str] = None,
        set: Optional[Values] = None,
        compiler: Optional[str] = None,
    ) -> Compiled:
        """Writes the equations as C, compiles them, and gives the compiled functions, which were compared with the interpreted ones.

        Without a folder the C is kept as long as this object. A `CompileError` says where there is no compiler, or results differ.
        """
        return build(self, folder, scene, set, compiler)

    def show(self, form: Optional[str] = None) -> str:
        """The derived equations as text; in a form (`"latex"`, `"python"`, `"c"`, `"rust"`, `"json"`) those of other programs."""
        return self._answer("show", [] if form is None else [f"--{form}"])

    def _answer(self, command: str, given: list[str]) -> str:
        text, problem = self._model.command(command, given)
        if problem:
            raise _error(problem)
        return text

    def _drawn(self, command: str, given: list[str], option: str, file: str) -> tuple[str, str]:
        """What a command prints, and the file that it draws."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, file)
            text = self._answer(command, [*given, f"--{option}={path}"])
            return text, path.read_text(encoding="utf-8")


def _restored(kept: Any) -> Mechanism:
    return Mechanism(_dalembert.Model.restored(kept))


def _drawn_modes(mechanism: Mechanism, given: list[str], option: str, file: str, mode: Optional[int] = None) -> str:
    return mechanism._drawn("modes", given + options(json=True, mode=mode), option, file)[1]


def _error(problem: Optional[tuple[str, str]]) -> Exception:
    kind, text = problem or ("InternalError", "a command wrote nothing")
    return getattr(_errors, kind)(text)


def _place(kind: str, name: str, known: Iterable[str]) -> int:
    names = list(known)
    if name in names:
        return names.index(name)
    near = difflib.get_close_matches(name, names, 1)
    hint = f"did you mean `{near[0]}`?" if near else f"there are {', '.join(names)}"
    raise _errors.UsageError(f"no {kind} is called `{name}`; {hint}")


def _table(given: Any, folder: str) -> Optional[str]:
    """The file of a table that is given as a file or as columns."""
    if given is None or isinstance(given, (str, os.PathLike)):
        return given if given is None else os.fspath(given)
    path = Path(folder, "given.csv")
    columns = {name: np.asarray(given[name], dtype=float) for name in given}
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise _errors.UsageError(f"columns of one length are wanted: {told}")
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(columns)
        table.writerows([repr(float(x)) for x in row] for row in zip(*columns.values()))
    return str(path)
