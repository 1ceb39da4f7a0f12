"""Keyword arguments are options of the program."""

import ast
import inspect
import re
from pathlib import Path

import numpy as np
import pytest

import dalembert
from dalembert import _dalembert
from dalembert._options import options, text_of

#: Options that Python does without: what writes files, and forms of printing, are methods of results.
ELSEWHERE = {
    "help",
    "size",
    "quiet",
    "json",
    "plot",
    "csv",
    "npz",
    "animate",
    "arrows",
    "mark-events",
    "save",
    "show",
    "section",
    "with",
    "no-digits",
    "symmetries",
    "matrices",
    "mode",
    "motion",
    "bode",
    "hertz",
    "locus",
    "campbell",
    "orders",
    "resume",
    "log",
    "merge",
    # Matrices for programs of control: `linearise` has them, with these inputs and outputs.
    "state-space",
    "in",
    "out",
}


@pytest.mark.parametrize("command", ["simulate", "modes", "sweep", "chart", "needs", "orbit", "solve"])
def test_every_option_is_a_keyword_and_every_keyword_an_option(program, command):
    known = set(re.findall(r"^ +(?:-\w, )?--([\w-]+)", program(command, "--help"), re.MULTILINE))
    parameters = inspect.signature(getattr(dalembert.Mechanism, command)).parameters
    ours = {name.rstrip("_").replace("_", "-") for name in parameters} - {"self"}
    assert ours <= known and known - ours <= ELSEWHERE


def test_values_keep_all_digits():
    assert text_of(0.1 + 0.2) == "0.30000000000000004" and float(text_of(5e-324)) == 5e-324
    assert options(set={"m": 2, "l": "3 cm"}, here=True, steady=False, from_="mode 1", max_steps=None) == [
        "--set=m=2",
        "--set=l=3 cm",
        "--here",
        "--from=mode 1",
    ]
    assert options(columns={"t": "A", "x": "B"}, vary={"l": [1.0, 2.5]}) == ["--columns=t=A,x=B", "--vary=l=1.0,2.5"]
    with pytest.raises(TypeError):
        text_of(object())


def test_stubs_name_what_the_native_module_has():
    text = Path(_dalembert.__file__).with_name("_dalembert.pyi").read_text(encoding="utf-8")
    module = ast.parse(text)
    functions = {node.name for node in module.body if isinstance(node, ast.FunctionDef)}
    classes = {node.name: node.body for node in module.body if isinstance(node, ast.ClassDef)}
    assert functions | classes.keys() == {name for name in dir(_dalembert) if not name.startswith("_")}
    for name, body in classes.items():
        stated = {node.target.id if isinstance(node, ast.AnnAssign) else node.name for node in body}
        assert stated == {name for name in dir(getattr(_dalembert, name)) if not name.startswith("_")}


def test_every_public_item_is_documented():
    for name in dalembert.__all__:
        item = getattr(dalembert, name)
        assert inspect.getdoc(item), name
        members = [member for key, member in vars(item).items() if not key.startswith("_")] if inspect.isclass(item) else []
        assert all(inspect.getdoc(member) for member in members if callable(member) or isinstance(member, property)), name


def test_an_array_of_one_number_is_a_number():
    assert options(set={"m": np.array(2.0)}) == ["--set=m=2.0"] == options(set={"m": np.float64(2)})


def test_values_that_are_no_numbers_are_usage_errors():
    model = dalembert.load("double_pendulum")
    assert model.equations(set={"m": np.array(2.0)}).rhs(0, [0, 0, 1, 1]) is not None
    for ask in (model.equations, model.compile):
        with pytest.raises(dalembert.UsageError, match="kg"):
            ask(set={"m": "2 kg m"})
        with pytest.raises(dalembert.UsageError, match="`mm`"):
            ask(set={"mm": 1})
        with pytest.raises(dalembert.UsageError, match="`nope`"):
            ask(scene="nope")


def test_values_of_equations_have_units_as_those_of_runs():
    model = dalembert.load("double_pendulum")
    inches, y = model.equations(set={"l": "40 cm", "m": "2*m"}), [0.3, 0.2, 1.0, -1.0]
    assert np.array_equal(inches.rhs(0, y), model.equations(set={"l": 0.4, "m": 2.0}).rhs(0, y))
    try:
        compiled = model.compile(set={"l": "40 cm", "m": "2*m"})
    except dalembert.CompileError:
        return
    assert np.allclose(compiled.rhs(0, y), inches.rhs(0, y), rtol=1e-13)


def test_a_state_is_saved_and_goes_on(tmp_path):
    model, path = dalembert.load("double_pendulum"), tmp_path / "half.yaml"
    whole = model.simulate(until=2, tolerance=1e-11)
    half = model.simulate(until=1, tolerance=1e-11, save=path)
    rest = model.simulate(until=2, tolerance=1e-11, state=path)
    assert rest.t[0] == 1 and np.array_equal(rest.y[0], half.y[-1]) and np.abs(rest.y[-1] - whole.y[-1]).max() < 1e-8
    with pytest.raises(dalembert.UsageError, match="save"):
        model.simulate(save=tmp_path / "half.csv")
    assert not (tmp_path / "half.csv").exists()
