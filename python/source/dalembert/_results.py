"""What commands answer: data, tables, pictures."""

from __future__ import annotations

import csv
import html
import io
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas


class Figure:
    """Charts, as SVG; a notebook shows them."""

    def __init__(self, svg: str):
        self.svg = svg

    def save(self, path: Union[str, Path]) -> None:
        """Writes the SVG."""
        Path(path).write_text(self.svg, encoding="utf-8")

    def _repr_html_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<Figure: {len(self.svg)} characters of SVG>"


class Animation:
    """A page that animates a mechanism; a notebook plays it."""

    def __init__(self, page: str):
        self.html = page

    def save(self, path: Union[str, Path]) -> None:
        """Writes the page, which needs nothing else."""
        Path(path).write_text(self.html, encoding="utf-8")

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        return f'<iframe srcdoc="{page}" width="100%" height="640" style="border:0"></iframe>'

    def __repr__(self) -> str:
        return f"<Animation: {len(self.html)} characters of HTML>"


class Report(Mapping[str, Any]):
    """What a command prints with `--json`, read; `json` is its text, `figure` its picture where it draws one."""

    def __init__(self, text: str, figure: Optional[Figure] = None):
        self.json = text
        self.data: dict[str, Any] = json.loads(text)
        self.figure = figure

    def __getitem__(self, key: str) -> Any:
        return self.data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    def _repr_html_(self) -> str:
        picture = self.figure.svg if self.figure else ""
        return f"{picture}<pre>{html.escape(json.dumps(self.data, indent=1, ensure_ascii=False))}</pre>"

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(self.data)}>"


class Orbit(Report):
    """A motion that repeats, or a family of them."""

    @property
    def period(self) -> float:
        """The period, s."""
        return self.data["period"]["value"]

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """The multipliers of the map that closes the motion."""
        return np.array([complex(one["re"], one["im"]) for one in self.data["multipliers"]], dtype=complex)


class _Table(Mapping[str, NDArray[Any]]):
    """Columns by name."""

    def __init__(self, text: str):
        lines = list(csv.reader(io.StringIO(text)))
        names = lines[0] if lines else []
        self._columns = {name: _column([line[place] for line in lines[1:]]) for place, name in enumerate(names)}

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def frame(self) -> pandas.DataFrame:
        """The table as a frame of pandas."""
        import pandas

        return pandas.DataFrame(self._columns)


def _column(cells: list[str]) -> NDArray[Any]:
    """Numbers, empty cells as NaN; else text."""
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells, dtype=object)


class Sweep(_Table):
    """Many runs: a row each, with what varies, ends, extremes and events, and what failed."""

    def __init__(self, text: str, figure: Figure):
        super().__init__(text)
        # A column of errors is text even where no run failed.
        lines = list(csv.reader(io.StringIO(text)))
        self._columns["error"] = np.array([line[-1] for line in lines[1:]], dtype=object)
        self._columns["run"] = self._columns["run"].astype(int)
        self.text = text
        self.figure = figure

    @property
    def failed(self) -> NDArray[np.int64]:
        """The numbers of the runs that failed."""
        return self["run"][self["error"] != ""]

    def _repr_html_(self) -> str:
        return self.figure.svg

    def __repr__(self) -> str:
        return f"<Sweep: {len(self['run'])} runs, {len(self.failed)} failed>"


class Chart(_Table):
    """Speed against accuracy: all points measured, what follows from them in words, and the chart."""

    def __init__(self, text: str, points: str, figure: Figure):
        super().__init__(points)
        self.text = text
        self.figure = figure

    def _repr_html_(self) -> str:
        return f"{self.figure.svg}<pre>{html.escape(self.text)}</pre>"

    def __repr__(self) -> str:
        return f"<Chart: {', '.join(self)}>"
