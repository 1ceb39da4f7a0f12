"""A notebook that shows a motion, a figure and an animation."""

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

CELLS = [
    "import dalembert\nmodel = dalembert.load('double_pendulum')",
    "motion = model.simulate(until=2)\nmotion",
    "motion.figure('theta1,theta2')",
    "motion.animation()",
    "motion.frame().describe()",
    "model.modes()",
    "model.sweep({'l': '1..2:3'}, until=1)",
]


def test_a_notebook_shows_results():
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    shown = [cell.outputs[-1]["data"].get("text/html", "") if cell.outputs else "" for cell in notebook.cells]
    assert [text.lstrip()[:4] for text in shown] == ["", "<svg", "<svg", "<ifr", "<div", "<svg", "<svg"]
