"""The examples of docs/bridges.md, where the programs they are for are installed."""

import pathlib
import re
import shlex
import shutil
import subprocess

import numpy as np
import pytest

import dalembert

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "bridges.md"


@pytest.fixture()
def section(program, tmp_path, monkeypatch):
    """Runs the commands of a section of the page; returns its other blocks of a kind."""
    monkeypatch.chdir(tmp_path)

    def blocks(heading, kind):
        text = PAGE.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]
        for command in re.findall(r"^cargo run --release -- (.*)$", text, re.MULTILINE):
            program(*shlex.split(command))
        return re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL)

    return blocks


@pytest.mark.parametrize(("heading", "module"), [("CasADi", "casadi"), ("JAX", "jax"), ("State space", "control")])
def test_examples_in_python_run(section, heading, module):
    pytest.importorskip(module)
    (block,) = section(heading, "python")
    exec(compile(block, str(PAGE), "exec"), {})


def test_constraints_are_solved_with_symbols(section):
    casadi = pytest.importorskip("casadi")
    (block,) = section("CasADi", "python")
    names, module = {}, {}
    exec(compile(block, str(PAGE), "exec"), names)
    exec(dalembert.load("slider_crank").show("python"), module)
    state = np.array([0.7, 0.2, 0.4]), np.array([1.0, 2.0, 3.0])
    expected = module["accelerations"](0, *state)
    module["np"] = names["module"]["np"]
    symbols = casadi.SX.sym("q", 3), casadi.SX.sym("v", 3)
    found = casadi.Function("f", symbols, module["accelerations"](0, *symbols))(*state)
    for ours, theirs in zip(expected, found):
        assert np.allclose(theirs.full().ravel(), ours, rtol=1e-11)


def test_matrices_are_variables_for_matlab(section):
    loadmat = pytest.importorskip("scipy.io").loadmat
    section("MATLAB and Octave", "matlab")
    section("State space", "python")
    mat, npz = loadmat("cart.mat"), np.load("cart.npz")
    assert sorted(name for name in mat if not name.startswith("__")) == sorted(npz)
    for name in npz:
        if name in "ABCD":
            assert mat[name].tobytes() == npz[name].tobytes(), name
        else:
            assert ["".join(cell) for cell in mat[name][0]] == npz[name].tolist(), name


def test_examples_in_octave_run(section, program):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("no Octave here")
    matrices, motion = section("MATLAB and Octave", "matlab")
    (gateway,) = section("MATLAB and Octave", "c")
    subprocess.run([octave, "--quiet", "--eval", matrices], check=True)
    if shutil.which("mkoctfile") is None:
        pytest.skip("no mkoctfile here: the gateway is not compiled")
    program("export", "double_pendulum", "--c", ".")
    pathlib.Path("double_pendulum_mex.c").write_text(gateway, encoding="utf-8")
    subprocess.run([octave, "--quiet", "--eval", f"{motion}\nsave -text motion.txt x"], check=True)
    end = np.loadtxt("motion.txt", comments="#")[-1]
    ours = dalembert.load("double_pendulum").simulate(until=1, tolerance=1e-10)
    assert np.abs(end - ours.y[-1]).max() < 1e-6


def test_a_block_of_simulink_moves_as_we_do(section, program):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler here: the block is not compiled")
    (block,) = section("Simulink", "c")
    program("export", "motor", "--c", ".")
    pathlib.Path("motor_block.c").write_text(block, encoding="utf-8")
    header = pathlib.Path(__file__).with_name("simulink")
    sources = ["motor_block.c", "motor.c", "dalembert_core.c"]
    subprocess.run([compiler, "-std=c99", f"-I{header}", "-I.", *sources, "-lm", "-o", "block"], check=True)
    end = np.array(subprocess.run(["./block"], check=True, capture_output=True, text=True).stdout.split(), dtype=float)
    ours = dalembert.load("motor").simulate()
    # Its states are q and q': the last coordinate's speed is the state of first order.
    assert np.allclose(end[[0, 2, 3]], [ours[name][-1] for name in ("phi", "phi'", "i")], rtol=1e-9)


@pytest.mark.parametrize("name", ["engine_map", "slider_crank"])
def test_jax_traces_tables_and_constraints(name):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    model, ours, traced = dalembert.load(name), {}, {}
    exec(model.show("python"), ours)
    exec(model.show("python"), traced)
    traced["np"] = jax.numpy
    x = np.linspace(0.2, 1.3, 2 * len(ours["COORDINATES"]))
    assert np.allclose(jax.jit(traced["rate"])(0.3, x), ours["rate"](0.3, x), rtol=1e-12)
    assert np.allclose(jax.jit(jax.jacobian(traced["rate"], 1))(0.3, x), model.jacobian(0.3, x), rtol=1e-9)
