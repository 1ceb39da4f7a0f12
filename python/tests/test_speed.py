"""The double pendulum to 1e-9, by us and by SciPy's DOP853 on the module that `show --python` prints, in one run."""

import time

import numpy as np
from scipy.integrate import solve_ivp

import dalembert


def seconds(work, times):
    best = np.inf
    for _ in range(times):
        began = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - began)
    return best


def test_a_run_is_fifty_times_faster_than_scipy():
    model = dalembert.load("double_pendulum")
    module = {}
    exec(model.show("python"), module)
    start = model.equations().y0

    def theirs():
        return solve_ivp(module["rate"], (0, 10), start, "DOP853", rtol=1e-9, atol=1e-9)

    def ours():
        return model.simulate(tolerance=1e-9, digits=False)

    ratio = seconds(theirs, 3) / seconds(ours, 20)
    print(f"\nSciPy {seconds(theirs, 1):.3f} s, dalembert {1e3 * seconds(ours, 20):.2f} ms: {ratio:.0f} times faster")
    assert np.allclose(theirs().y[:, -1], ours().y[-1], atol=1e-3)
    assert ratio >= 50
