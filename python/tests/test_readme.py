"""The examples of README.md, one after the other."""

import pathlib
import re

README = pathlib.Path(__file__).parent.with_name("README.md")


def test_the_examples_run(tmp_path, monkeypatch):
    text = README.read_text(encoding="utf-8")
    files = re.findall(r"`(\w+\.yaml)`:\n\n```yaml\n(.*?)```", text, re.DOTALL)
    for name, content in files:
        (tmp_path / name).write_text(content, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) >= 8 and files
    names = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)
