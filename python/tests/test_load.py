import pytest

import dalembert

TEXT = """
name: Swing
parameters: {m: 1 kg, l: 2 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: "l*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
scene: {start: {theta: 0.5}, until: 1}
"""


def test_a_model_of_the_library_goes_by_its_name():
    assert "double_pendulum" in dalembert.models()
    model = dalembert.load("double_pendulum")
    assert (model.name, list(model.coordinates)) == ("double_pendulum", ["theta1", "theta2"])
    assert model.parameters == {"m": 1.0, "l": 1.0, "g": 10.0}
    assert model.parameter_units["g"] == "m/s^2"
    assert list(model.outputs.items())[0] == ("tip", "m")


def test_a_text_and_a_file_are_the_same_model(tmp_path):
    path = tmp_path / "swing.yaml"
    path.write_text(TEXT)
    of_text, of_path, of_name = dalembert.load(TEXT), dalembert.load(path), dalembert.load(str(path))
    assert (of_text.name, of_path.name, of_name.name) == ("Swing", "swing", "swing")
    ends = {model.simulate().y[-1].tobytes() for model in (of_text, of_path, of_name)}
    assert len(ends) == 1


@pytest.mark.parametrize("stated", ["# name: Old\nname: Swing", 'name: "Swing"', "'name': 'Swing'", "name : Swing # name: Old"])
def test_a_text_goes_by_the_name_that_it_states(stated):
    assert dalembert.load(TEXT.replace("name: Swing", stated)).name == "Swing"


def test_names_that_are_not_the_models_are_none_of_it():
    text = "parameters: {m: 1 kg}\ncoordinates: {x: m}\nbodies:\n  name:\n    {mass: m, position: '[x, 0]'}\nname: Last\nscene: {until: 1}"
    assert dalembert.load(text).name == "Last"
    flow = "{parameters: {m: 1 kg}, coordinates: {x: m}, bodies: {b: {mass: m, position: '[x, 0]'}}, name: Flow, scene: {until: 1}}"
    assert dalembert.load(flow).name == "Flow" and dalembert.load(flow, name="mine").name == "mine"


def test_sizes_are_other_sizes():
    assert len(dalembert.load("chain", sizes={"n": 7}).coordinates) == 7


def test_all_mistakes_come_together_with_their_places(tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text(TEXT.replace("-cos(theta)", "-cos(thta)").replace("-g]", "-gg]"))
    with pytest.raises(dalembert.ModelError) as raised:
        dalembert.load(path)
    first, second = sorted(raised.value.problems, key=lambda problem: problem.line)
    assert (first.line, first.column, first.severity, first.file) == (5, 56, "error", str(path))
    assert first.text == "unknown name `thta`" and first.help == "did you mean `theta`?"
    assert second.line == 6 and "`gg`" in second.text
    assert first.code.startswith("E") and str(first).startswith(f"{path}:5:56: error[E")
    assert "^" in str(raised.value)


def test_a_name_that_is_not_known_is_answered_with_one_that_is():
    with pytest.raises(dalembert.UsageError, match="did you mean `double_pendulum`"):
        dalembert.load("double_pendulm")
    with pytest.raises(dalembert.UsageError, match="did you mean `theta1`"):
        dalembert.load("double_pendulum").simulate(start={"theta": 1})
    with pytest.raises(dalembert.UsageError, match="did you mean `scene`"):
        dalembert.load("double_pendulum").equations("scen")


def test_warnings_of_a_file_are_problems():
    (warning,) = dalembert.load(TEXT.replace("{mass: m,", "{mass: m, angle: theta,")).warnings
    assert (warning.severity, warning.line) == ("warning", 5) and warning.code.startswith("W")
    assert dalembert.load(TEXT).warnings == ()


def test_show_prints_equations_and_modules():
    model = dalembert.load(TEXT)
    assert "equations of motion" in model.show()
    assert "def mass_matrix" in model.show("python")


def test_the_source_is_the_file():
    model = dalembert.load(TEXT)
    assert model.source == TEXT
