"""From keyword arguments to the options of the program."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any, Union

import numpy as np

#: A number in SI units, or an expression of the model language with a unit: `"30 deg"`.
Value = Union[float, str]
#: Values by name.
Values = Mapping[str, Value]

#: Options of several names that are given once, with commas between them.
_ONCE = {"columns", "map"}


def text_of(value: Any) -> str:
    """A value as the command line has it, with all digits."""
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return text_of(value[()])
    if isinstance(value, Iterable):
        return ",".join(text_of(one) for one in value)
    raise TypeError(f"no option has a value of the type {type(value).__name__}")


def options(**given: Any) -> list[str]:
    """`set={"m": 2}` becomes `--set=m=2`, `until=5` becomes `--until=5`, True a flag; None and False are left out."""
    line: list[str] = []
    for name, value in given.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            line.append(option)
        elif isinstance(value, Mapping):
            pairs = [f"{key}={text_of(one)}" for key, one in value.items()]
            line += [f"{option}={','.join(pairs)}"] if name in _ONCE and pairs else [f"{option}={pair}" for pair in pairs]
        else:
            line.append(f"{option}={text_of(value)}")
    return line
