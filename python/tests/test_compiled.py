import numpy as np
import pytest

import dalembert


@pytest.mark.parametrize("name", ["double_pendulum", "slider_crank", "motor", "stick_slip", "whipple_bicycle", "shaken_pendulum"])
def test_compiled_and_interpreted_results_are_the_same(name):
    model = dalembert.load(name)
    compiled, equations = model.compile(), model.equations()
    assert compiled.difference <= 1e-12
    y = equations.y0 + 0.01
    for compute in ("rhs", "mass_matrix", "bias"):
        ours, theirs = getattr(compiled, compute)(0.2, y), getattr(equations, compute)(0.2, y)
        assert np.allclose(ours, theirs, rtol=1e-12, atol=1e-12 * (1 + np.abs(theirs).max())), compute


def test_the_double_pendulum_has_the_same_bits(tmp_path):
    model = dalembert.load("double_pendulum")
    compiled = model.compile(tmp_path, set={"l": 0.3})
    equations = model.equations(set={"l": 0.3})
    for y in np.random.default_rng(2).normal(size=(50, 4)):
        assert np.array_equal(compiled.rhs(0.0, y), equations.rhs(0.0, y))
    assert {path.suffix for path in tmp_path.iterdir()} == {".c", ".h", ".so"}


def test_without_a_compiler_it_says_so(tmp_path):
    model = dalembert.load("double_pendulum")
    with pytest.raises(dalembert.CompileError, match="no C compiler here"):
        model.compile(compiler="no-such-compiler")
    with pytest.raises(dalembert.CompileError, match="failed"):
        model.compile(tmp_path, compiler="false")


def test_states_of_another_size_are_refused():
    with pytest.raises(ValueError, match="a state has 4 numbers"):
        dalembert.load("double_pendulum").compile().rhs(0, [1.0])
