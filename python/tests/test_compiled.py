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


@pytest.mark.parametrize("number", [int, np.int64, np.float32, float])
def test_times_are_numbers_of_any_kind(number):
    model = dalembert.load("base_excitation")
    compiled, equations = model.compile(), model.equations()
    for given in (np.array([0.1, 0.2]), np.array([0.1, 9.0, 0.2, 9.0])[::2], [np.float32(0.1), 1]):
        before = np.array(given)
        for compute in ("rhs", "mass_matrix", "bias"):
            assert np.array_equal(getattr(compiled, compute)(number(1), given), getattr(equations, compute)(1.0, given)), compute
        assert np.array_equal(given, before)
    assert np.isnan(compiled.rhs(number(1), [np.nan, 0.0])).any()


LAW = """
name: Law
parameters: {m: 1 kg, F: 3 N, k: 2 N/m, t1: 0.95 s, w: 4 rad/s}
coordinates: {x: m}
inputs: {u: INPUT}
memory: {held: 1 N}
bodies: {b: {mass: m, position: "[x, 0]"}}
forces: {f: {on: b, force: "[u + held - k*sign(u - F/2)*abs(x), 0]"}}
scene: {start: {x: 0.3, held: 5}, until: 1}
"""


@pytest.mark.parametrize("signal", ["F*step(t1 - t)", "F*step(t - t1)", "F*sign(sin(w*t))", "F*abs(sin(w*t))", "F*sin(w*t)"])
def test_inputs_are_on_the_side_of_the_time_and_values_are_held(signal):
    model = dalembert.load(LAW.replace("INPUT", signal))
    compiled, equations = model.compile(), model.equations()
    for t in (0.2, 0.93, 0.97, 0.1):
        for y in ([0.3, 0.1], [-0.3, 0.1]):
            assert np.allclose(compiled.rhs(t, y), equations.rhs(t, y), rtol=1e-14), (t, y)
    if signal == "F*step(t1 - t)":
        assert [compiled.rhs(t, [0.0, 0.0])[1] for t in (0.9, 0.97)] == [8, 5]


def chain(count, stiffness="k"):
    names = [f"x{k}" for k in range(count)]
    bodies = ", ".join(f'b{k}: {{mass: m, position: "[{name}, 0]"}}' for k, name in enumerate(names))
    springs = ", ".join(f"s{k}: {{stretch: {name}, stiffness: {stiffness}, along: ground.x, on: b{k}}}" for k, name in enumerate(names))
    coordinates = ", ".join(f"{name}: m" for name in names)
    return f"name: Chain\nparameters: {{m: 2 kg, k: 50 N/m}}\ncoordinates: {{{coordinates}}}\nbodies: {{{bodies}}}\nsprings: {{{springs}}}\nscene: {{start: {{x0: 0.1}}, until: 1}}\n"


def test_other_equations_in_the_same_folder_are_other_code(tmp_path):
    kept = []
    for count, stiffness in ((20, "k"), (1, "k"), (2, "k"), (2, "2*k"), (1, "k")):
        model = dalembert.load(chain(count, stiffness))
        compiled = model.compile(tmp_path)
        y = np.linspace(0.1, 1, 2 * count)
        for compute in ("rhs", "mass_matrix", "bias"):
            assert np.array_equal(getattr(compiled, compute)(0.0, y), getattr(model.equations(), compute)(0.0, y)), compute
        assert [path for path in tmp_path.iterdir() if path.suffix not in (".c", ".h")] == [compiled.library]
        kept.append((compiled, y, compiled.rhs(0.0, y)))
    # Those of before stay what they are.
    for compiled, y, rate in kept:
        assert np.array_equal(compiled.rhs(0.0, y), rate)


@pytest.mark.parametrize("name", ["ladder", "rocking_block", "two_blocks"])
def test_contacts_are_in_the_phase_of_the_start(name):
    model = dalembert.load(name)
    compiled, equations = model.compile(), model.equations()
    assert np.allclose(compiled.rhs(0.0, equations.y0), equations.rhs(0.0, equations.y0), rtol=1e-12, atol=1e-12)


def test_scenes_of_the_c_start_in_their_phases():
    text = """
name: Slide
parameters: {m: 1 kg, F: 3 N}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
friction: {rub: {rate: x', on: b, along: ground.x, limit: F}}
scene: {start: {x': -2}, until: 1}
scenes: {ahead: {start: {x': 2}, until: 1}, rest: {start: {x': 0}, until: 1}}
"""
    model = dalembert.load(text)
    compiled = model.compile()
    phases = {"scene": "rub slips backwards", "ahead": "rub slips forwards", "rest": "rub sticks"}
    for place, (scene, phase) in enumerate(phases.items()):
        settings, q, v = np.zeros(3), np.zeros(1), np.zeros(1)
        compiled._call("scene", place, compiled._constants, settings, q, v)
        assert model.phases[compiled._call("phase", compiled._constants)] == phase == model.phases[model.equations(scene).phase]
    # The same of the module for NumPy.
    module = {}
    exec(model.show("python"), module)
    assert list(module["rate"](0.0, [0.0, -2.0])) == [-2, 3]
