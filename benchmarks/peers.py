"""The scenes of `peers` in SciPy, CasADi and heyoka, and the tables of all programs.

pip install numpy numba scipy casadi heyoka
python peers.py measure FOLDER                  adds `python.csv` to what `cargo run --bin peers FOLDER` wrote
python peers.py table FOLDER [DEFAULT BUILD'S]  prints the tables

Equations are compiled by numba for SciPy, by the C compiler for CasADi and by LLVM for heyoka, all for the processor at hand
and before the clock runs.
"""

import csv
import math
import os
import statistics
import sys
import time
import warnings

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import casadi as ca
import heyoka as hy
import numba
import numpy as np
import scipy.integrate

ERRORS = [1e-6, 1e-9]
TOLERANCES = [10.0**-i for i in range(4, 15)]
SECONDS = 3.0  # rounds of one program go on for so long, but there are 3 at least and 41 at most
LONGEST = 3.0  # runs that take longer are left out


# Equations of motion, with the sines and cosines of any of the programs.


def kepler(m):
    def rates(s):
        cube = (s[0] * s[0] + s[1] * s[1]) ** -1.5
        return [s[2], s[3], -cube * s[0], -cube * s[1]]

    return rates


def double_pendulum(m):
    def rates(y):
        s, c = m.sin(y[0] - y[1]), m.cos(y[0] - y[1])
        m11, m12, m22 = 4 / 3, 0.5 * c, 1 / 3
        f = -0.5 * s * y[3] * y[3] - 15.0 * m.sin(y[0])
        g = 0.5 * s * y[2] * y[2] - 5.0 * m.sin(y[1])
        factor = 1.0 / (m11 * m22 - m12 * m12)
        return [y[2], y[3], factor * (m22 * f - m12 * g), factor * (m11 * g - m12 * f)]

    return rates


def figure_eight(m):
    def rates(y):
        a = [0.0 * y[0] for _ in range(6)]
        for i, j in [(0, 1), (0, 2), (1, 2)]:
            dx, dy = y[j] - y[i], y[3 + j] - y[3 + i]
            factor = (dx * dx + dy * dy) ** -1.5
            a[i], a[j] = a[i] + factor * dx, a[j] - factor * dx
            a[3 + i], a[3 + j] = a[3 + i] + factor * dy, a[3 + j] - factor * dy
        return [y[6 + i] for i in range(6)] + a

    return rates


def rods(m):
    n = 10

    def rates(y):
        s, c = [m.sin(y[i]) for i in range(n)], [m.cos(y[i]) for i in range(n)]
        a = [-10.0 * (0.5 + (n - 1 - i)) * s[i] for i in range(n)]
        mass = [1 / 3 + (n - 1 - k // n) + 0.0 * s[0] for k in range(n * n)]
        for i in range(n):
            k = 0.5 + (n - 1 - i)
            for j in range(i):
                mass[i * n + j] = k * (c[i] * c[j] + s[i] * s[j])
                turning = k * (s[i] * c[j] - c[i] * s[j])
                a[i] = a[i] - turning * y[n + j] * y[n + j]
                a[j] = a[j] + turning * y[n + i] * y[n + i]
        for i in range(n):
            for j in range(i):
                for k in range(j):
                    mass[i * n + j] = mass[i * n + j] - mass[i * n + k] * mass[j * n + k]
            for j in range(i):
                factor = mass[i * n + j] * mass[j * n + j]
                mass[i * n + i] = mass[i * n + i] - factor * mass[i * n + j]
                mass[i * n + j] = factor
                a[i] = a[i] - factor * a[j]
            mass[i * n + i] = 1.0 / mass[i * n + i]
        for step in range(n):
            i = n - 1 - step
            a[i] = a[i] * mass[i * n + i]
            for j in range(i + 1, n):
                a[i] = a[i] - mass[j * n + i] * a[j]
        return [y[n + i] for i in range(n)] + a

    return rates


def stiff_pendulum(damping):
    def scene(m):
        def rates(y):
            square = y[0] * y[0] + y[1] * y[1]
            factor = 1e6 * (square**-0.5 - 1.0) - damping * (y[0] * y[2] + y[1] * y[3]) / square
            return [y[2], y[3], factor * y[0], factor * y[1] - 10.0]

        return rates

    return scene


SCENES = {
    "Kepler": kepler,
    "double pendulum": double_pendulum,
    "chain of ten": rods,
    "figure eight": figure_eight,
    "stiff pendulum": stiff_pendulum(0.0),
    "stiff pendulum, damped": stiff_pendulum(2000.0),
}


# Programs: from a scene, its start and its end in time to a function that prepares a run at a tolerance.


def symbols(scene, size):
    """The scene in heyoka's variables."""
    y = hy.make_vars(*[f"y{i:02}" for i in range(size)])
    return y, scene(hy)(y)


def scipy_method(method, jacobian):
    def prepare(scene, start, until):
        rates = numba.njit(scene(math))
        f = numba.njit(lambda t, y: np.array(rates(y)))
        f(0.0, start)
        options = {}
        if jacobian:
            y, expressions = symbols(scene, len(start))
            slopes = hy.cfunc([hy.diff(e, v) for e in expressions for v in y], y)
            options["jac"] = lambda t, y: slopes(y).reshape(len(y), len(y))

        def at(tolerance):
            def run():
                found = scipy.integrate.solve_ivp(
                    f, (0.0, until), start, method=method, rtol=tolerance, atol=tolerance, **options
                )
                return found.y[:, -1] if found.success else None

            return run

        return at

    return prepare


def cvodes(formula, iteration):
    def prepare(scene, start, until):
        y = ca.SX.sym("y", len(start))
        system = {"x": y, "ode": ca.vertcat(*scene(ca)([y[i] for i in range(len(start))]))}

        def at(tolerance):
            options = {"abstol": tolerance, "reltol": tolerance, "max_num_steps": 100_000_000}
            options |= {"linear_multistep_method": formula, "nonlinear_solver_iteration": iteration}
            options |= {"disable_internal_warnings": True}
            options |= {"jit": True, "compiler": "shell", "jit_options": {"flags": ["-O3", "-march=native"]}}
            integrator = ca.integrator("peer", "cvodes", system, 0, until, options)

            def run():
                try:
                    return np.array(integrator(x0=start)["xf"])[:, 0]
                except RuntimeError:
                    return None

            return run

        return at

    return prepare


def taylor(scene, start, until):
    y, expressions = symbols(scene, len(start))

    def at(tolerance):
        integrator = hy.taylor_adaptive(list(zip(y, expressions)), start, tol=tolerance)

        def run():
            integrator.state[:] = start
            integrator.time = 0.0
            outcome = integrator.propagate_until(until, max_steps=100_000)[0]
            return integrator.state.copy() if outcome == hy.taylor_outcome.time_limit else None

        return run

    return at


EXPLICIT = [
    ("heyoka", "taylor_adaptive", taylor),
    ("CasADi", "cvodes, Adams", cvodes("adams", "functional")),
    ("SciPy", "DOP853", scipy_method("DOP853", False)),
]
IMPLICIT = [
    ("CasADi", "cvodes, BDF", cvodes("bdf", "newton")),
    ("SciPy", "Radau", scipy_method("Radau", True)),
    ("heyoka", "taylor_adaptive", taylor),
    ("SciPy", "DOP853", scipy_method("DOP853", False)),
]


# What an error costs, as in `src/peers/curve.rs` and `src/bin/peers.rs`.


def clocked(run):
    began = time.process_time()
    found = run()
    return time.process_time() - began, found


def curve(at, end, tolerances):
    tried = []
    for tolerance in tolerances:
        run = at(tolerance)
        run()
        seconds, found = clocked(run)
        if found is not None:
            tried.append((np.abs(found[: len(end)] - end).max(), run, [seconds]))
        if seconds > LONGEST:
            break
    once = sum(times[0] for _, _, times in tried)
    for _ in range(int(min(max(SECONDS / max(once, 1e-9), 2), 40))):
        for _, run, times in tried:
            times.append(clocked(run)[0])
    runs = [(error, statistics.median(times)) for error, _, times in tried]
    best = min(range(len(runs)), key=lambda i: runs[i][0], default=-1)
    return runs[: best + 1]


def time_at(runs, error):
    reaching = [seconds for found, seconds in runs if found <= error]
    if not reaching:
        return None
    near = [(math.log(found / error), math.log(s)) for found, s in runs if error / 100 <= found <= error * 100]
    if len(near) < 3 or all(x <= 0 for x, _ in near):
        return min(reaching)
    return math.exp(np.polyfit(*zip(*near), 1)[1])


# Files and tables.


def read(folder, *names):
    """Seconds by scene, program with its method, and error."""
    seconds = {}
    for name in names:
        with open(os.path.join(folder, name), newline="") as file:
            for row in csv.DictReader(file):
                key = row["scene"], f"{row['program']} `{row['method']}`", float(row["error"])
                seconds[key] = float(row["seconds"])
    return seconds


def measure(folder):
    """Writes what the programs of this file take."""
    warnings.simplefilter("ignore")  # SciPy's, that a tolerance is below what it takes
    with open(os.path.join(folder, "ends.csv"), newline="") as file:
        scenes = list(csv.reader(file))
    with open(os.path.join(folder, "python.csv"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["scene", "program", "method", "error", "seconds"])
        for name, until, *numbers in scenes:
            size = len(numbers) // 3 * 2
            start, end = np.array(numbers[:size], dtype=float), np.array(numbers[size:], dtype=float)
            for program, method, prepare in IMPLICIT if name.startswith("stiff") else EXPLICIT:
                # Each tolerance of heyoka is another order, and compiled anew: half a minute for the chain.
                # Its errors are a thousandth of its tolerances there.
                few = program == "heyoka" and size > 12
                at = prepare(SCENES[name], start, float(until))
                runs = curve(at, end, TOLERANCES[:4] if few else TOLERANCES)
                print(name, program, method, [(f"{e:.0e}", f"{s:.1e}") for e, s in runs], file=sys.stderr)
                found = [(error, time_at(runs, error)) for error in ERRORS]
                rows.writerows([name, program, method, error, s] for error, s in found if s is not None)
                file.flush()


def table(base, columns, builds):
    """Times of `base` in ms, of all others as multiples of it; those of the default build in brackets."""
    rows = list(dict.fromkeys(key[1] for times in builds for key in times if (key[0], key[2]) in columns))
    rows.sort(key=lambda row: (row != base, not row.startswith("dalembert")))
    print("\n| | " + " | ".join(f"{scene}, 1e{math.log10(error):.0f}" for scene, error in columns) + " |")
    print("| --- |" + " ---: |" * len(columns))
    for row in rows:
        cells = [cell(row, base, scene, error, builds) for scene, error in columns]
        print(f"| {row}{', ms' if row == base else ''} | " + " | ".join(cells) + " |")


def cell(row, base, scene, error, builds):
    figures = []
    for times in builds:
        own, found = times.get((scene, base, error)), times.get((scene, row, error))
        if own is None or found is None:
            figures.append("–")
        else:
            figures.append(f"{1e3 * own:.3g}" if row == base else f"{found / own:.2f}")
    first, *rest = figures
    return first if first == "–" else first + "".join(f" ({other})" for other in rest)


def tables(folder, *default):
    """What was measured, one table for explicit methods and one for stiff scenes."""
    builds = [read(folder, "times.csv", "python.csv")]
    builds += [read(other, "times.csv") | read(folder, "python.csv") for other in default]
    explicit = [name for name in SCENES if not name.startswith("stiff")]
    table("dalembert `dop853`", [(name, error) for name in explicit for error in ERRORS], builds)
    table("dalembert `radau5`", [(name, 1e-6) for name in SCENES if name.startswith("stiff")], builds)


if __name__ == "__main__":
    {"measure": measure, "table": tables}[sys.argv[1]](*sys.argv[2:])
