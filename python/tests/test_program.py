import csv
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

PROGRAM = Path(sys.executable).with_name("dalembert")


def test_the_wheel_carries_the_program(program):
    assert "double_pendulum" in program("list")
    assert program("--version").startswith("dalembert ")
    assert "theta1 =" in program("simulate", "double_pendulum")


def test_exit_codes_are_the_programs(program, tmp_path):
    program("simulate", "double_pendulm", status=2)
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("name: Wrong")
    program("check", str(wrong), status=1)


def test_a_table_is_written_as_arrays(program, tmp_path):
    table, arrays = tmp_path / "table.csv", tmp_path / "table.npz"
    program("sweep", "double_pendulum", "--vary=l=0.5..2:5", "--until=1", f"--csv={table}", f"--npz={arrays}")
    rows, found = list(csv.reader(table.read_text(encoding="utf-8").splitlines())), np.load(arrays)
    assert list(found) == rows[0] and found["run"].tolist() == [0, 1, 2, 3, 4] and not any(found["error"])
    for name, *column in list(zip(*rows))[1:-1]:
        assert np.array_equal(found[name], [float(x) if x else np.nan for x in column], equal_nan=True), name


def test_ctrl_c_writes_what_was_computed():
    words = ["simulate", "double_pendulum", "--until=1e7", "--every=1e6", "--max-steps=1000000000000", "--json"]
    process = subprocess.Popen([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(2)
    process.send_signal(signal.SIGINT)
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 1 and '"model":"double_pendulum"' in out.replace(" ", "") and "interrupted" in err
