"""What calls give back."""

from __future__ import annotations

import json
import math
import os
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from . import _limn, _settings, _text
from ._limn import Chain, ResolvedCamera

Table = Dict[str, List[Any]]


def number_or_text(text: Any) -> Any:
    """Parameters are texts; those that are numbers are more useful as such."""
    for kind in (int, float):
        try:
            return kind(text)
        except (TypeError, ValueError):
            continue
    return text


def table_of(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Columns of rows, in the order in which they first come; what a row lacks is NaN among numbers, else None."""
    names: List[str] = []
    for row in rows:
        names.extend(name for name in row if name not in names)
    table: Table = {}
    for name in names:
        column = [row.get(name) for row in rows]
        numeric = all(value is None or isinstance(value, (int, float)) and not isinstance(value, bool) for value in column)
        some = any(value is not None for value in column)
        table[name] = [math.nan if value is None and numeric and some else value for value in column]
    return table


def _flat(row: Mapping[str, Any]) -> Dict[str, Any]:
    """Parameters as columns of their own: those of surfaces by their names, those of methods as "rim.threshold"."""
    flat: Dict[str, Any] = {}
    for name, value in row.items():
        if name == "surface_parameters":
            flat.update({key: number_or_text(text) for key, text in value.items()})
        elif name == "method_parameters":
            flat.update({f"{row['method']}.{key}": number_or_text(text) for key, text in value.items()})
        else:
            flat[name] = value
    return flat


class Lines:
    """The lines of a view, hidden ones included. A notebook shows the visible ones as SVG."""

    def __init__(self, lines: "_limn.Lines") -> None:
        self._lines = lines

    @property
    def chains(self) -> List[Chain]:
        """Strokes of one class and visibility each, in an order that does not depend on threads."""
        return self._lines.chains

    @property
    def visible(self) -> List[Chain]:
        """Those with nothing in front of them."""
        return [chain for chain in self._lines.chains if chain.visible]

    @property
    def conflicts(self) -> List[Tuple[str, Tuple[float, float]]]:
        """Where the certificate disagrees: what, and (x, y) in pixels. Empty: it holds."""
        return self._lines.conflicts

    @property
    def camera(self) -> ResolvedCamera:
        """Where they were seen from."""
        return self._lines.camera

    @property
    def exact(self) -> bool:
        """False where a part of the scene is left out or approximated: notes."""
        return self._lines.exact

    @property
    def bound_px(self) -> float:
        """No point lies farther from its line, pixels."""
        return self._lines.bound_px

    @property
    def source(self) -> str:
        """What they were solved on, in words."""
        return self._lines.source

    @property
    def notes(self) -> List[str]:
        """What the bound does not cover."""
        return self._lines.notes

    @property
    def warnings(self) -> List[str]:
        """What a person should know before trusting them."""
        return self._lines.warnings

    def svg(
        self,
        *,
        hidden: bool = False,
        layers: Any = None,
        style: Any = "plain",
        curves: str = "polyline",
        fit: Optional[float] = None,
        page: Any = None,
    ) -> str:
        """The drawing as SVG. hidden: hidden lines too, dashed. layers: only lines with so many layers of surface in front of them, 1 or
        (0, 2). style: "plain", "technical", "ink" or a .css file. curves: "polyline", "bezier" or "arc", within fit pixels (0.05). page:
        (width, height) in millimetres; missing: a unit is a pixel."""
        return self._lines._svg(self._drawing(hidden, layers, style, curves, fit, page))

    def write(
        self,
        file: Union[str, "os.PathLike[str]"],
        *,
        hidden: bool = False,
        layers: Any = None,
        style: Any = "plain",
        curves: str = "polyline",
        fit: Optional[float] = None,
        page: Any = None,
    ) -> None:
        """Writes .svg, .pdf, .dxf, or .json (everything that limn knows of the lines). Settings as for svg()."""
        self._lines._write(_text.path(file), self._drawing(hidden, layers, style, curves, fit, page))

    def graph(self) -> Dict[str, Any]:
        """Vertices, edges and chains of the view graph, as `limn contours -o lines.json` writes them."""
        return json.loads(self._lines._json())

    @staticmethod
    def _drawing(hidden: bool, layers: Any, style: Any, curves: str, fit: Optional[float], page: Any) -> _text.Fields:
        fields: _text.Fields = []
        _settings.drawing_fields(fields, hidden, layers, curves, fit, page, style)
        return fields

    def _repr_svg_(self) -> str:
        return self._lines._repr_svg_()

    def __repr__(self) -> str:
        return f"<limn.Lines: {len(self.chains)} chains, {len(self.conflicts)} conflicts, bound {self.bound_px:.3g} px>"


class Measures(Mapping[str, float]):
    """Values by name, as a mapping: measures["border_error_p95"]. NaN where there was nothing to measure."""

    def __init__(self, rows: Sequence[Tuple[str, float, str, float]]) -> None:
        self._values = {name: value for name, value, _, _ in rows}
        self.units: Dict[str, str] = {name: unit for name, _, unit, _ in rows}
        """Units by name: "px", "deg", "" for shares and counts."""
        self.floors: Dict[str, float] = {name: floor for name, _, _, floor in rows}
        """What the reference itself scores: nothing below it can be told of any model. NaN where there is no such figure."""

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    @property
    def table(self) -> Table:
        """Columns metric, value, unit, floor: pandas.DataFrame(measures.table)."""
        return table_of(
            [{"metric": name, "value": value, "unit": self.units[name], "floor": self.floors[name]} for name, value in self._values.items()]
        )

    def __repr__(self) -> str:
        return f"<limn.Measures: {len(self)} values>"


class Comparison:
    """A scene's models beside a reference. A notebook shows the contact sheet."""

    def __init__(self, comparison: "_limn.Comparison") -> None:
        self._comparison = comparison

    @property
    def models(self) -> List[str]:
        """Names; the first is the reference."""
        return self._comparison.models

    @property
    def methods(self) -> List[str]:
        """Names."""
        return self._comparison.methods

    @property
    def call(self) -> str:
        """The command line that makes the same comparison."""
        return self._comparison.call

    @property
    def summary(self) -> List[str]:
        """The result in sentences with numbers."""
        return self._comparison.summary

    @property
    def skipped(self) -> List[str]:
        """What is not there, and why."""
        return self._comparison.skipped

    @property
    def rows(self) -> List[Dict[str, Any]]:
        """One for each number, as rows.json has them."""
        return json.loads(self._comparison._rows())

    @property
    def table(self) -> Table:
        """The rows as columns: pandas.DataFrame(comparison.table)."""
        return table_of([_flat({**row, "method_parameters": {}}) for row in self.rows])

    def _index(self, model: str, method: Optional[str]) -> Tuple[int, int]:
        for kind, name, known in (("model", model, self.models), ("method", method, self.methods)):
            if name is not None and name not in known:
                raise _text.refuse(kind, name, f"unknown {kind}", ", ".join(known))
        return self.models.index(model), 0 if method is None else self.methods.index(method)

    def border(self, model: str, method: Optional[str] = None) -> Any:
        """Coverage of the ink: (height, width) float32, without a copy. None where the cell was skipped."""
        return self._comparison._border(*self._index(model, method))

    def composite(self, model: str, method: Optional[str] = None) -> Any:
        """sRGB with alpha: (height, width, 4) uint8, without a copy. None where the cell was skipped."""
        return self._comparison._composite(*self._index(model, method))

    def report(self) -> str:
        """The page as HTML that works from disk."""
        return self._comparison._report()

    def write(self, folder: Union[str, "os.PathLike[str]"]) -> None:
        """sheet.png, rows.json and report.html into a folder, which is made."""
        name = _text.path(folder)
        os.makedirs(name, exist_ok=True)
        self._comparison._write(name)

    def _repr_png_(self) -> bytes:
        return self._comparison._repr_png_()

    def __repr__(self) -> str:
        return f"<limn.Comparison: {len(self.models)} models, {len(self.methods)} methods>"


class Study:
    """A sweep over models, with one row for each number that was measured."""

    def __init__(self, study: "_limn.DoneStudy", folder: Optional[str]) -> None:
        self._study = study
        self.folder = folder
        """Where rows.csv, the charts and report.html are; None where no folder was asked for."""

    @property
    def rows(self) -> List[Dict[str, Any]]:
        """As rows.jsonl has them, in the study's order."""
        return [json.loads(line) for line in self._study.rows]

    @property
    def table(self) -> Table:
        """The rows as columns, parameters as columns of their own: pandas.DataFrame(study.table)."""
        return table_of([_flat(row) for row in self.rows])

    @property
    def summary(self) -> str:
        """The report's first sentences."""
        return self._study.summary

    @property
    def call(self) -> str:
        """The command line that makes the same study."""
        return self._study.call

    @property
    def truth(self) -> str:
        """What was measured against, in words."""
        return self._study.truth

    @property
    def failed_cells(self) -> int:
        """Cells with a reason (the column "failed") instead of values."""
        return self._study.failed_cells

    @property
    def warnings(self) -> List[str]:
        """What a person should know before trusting it."""
        return self._study.warnings

    def __repr__(self) -> str:
        return f"<limn.Study: {len(self._study.rows)} rows>"


class Plan(Mapping[str, Any]):
    """The cheapest model that is good enough, as `limn plan --json` prints it."""

    def __init__(self, document: Dict[str, Any]) -> None:
        self._document = document

    def __getitem__(self, name: str) -> Any:
        return self._document[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    @property
    def chosen(self) -> Optional[Dict[str, Any]]:
        """The model: surface, parameters, measured_px, bytes, time_ms. None where nothing meets the tolerance."""
        return self._document["chosen"]

    @property
    def settings(self) -> Dict[str, Any]:
        """The chosen model as arguments of render() and measure()."""
        if self.chosen is None:
            raise _text.refuse("tolerance", self._document["tolerance_px"], "no model meets it", "a larger one")
        return {"surface": self.chosen["surface"], **self.chosen["parameters"]}

    @property
    def doubt(self) -> str:
        """Why nothing can be called right to the tolerance; empty where it can."""
        return self._document["doubt"]

    @property
    def summary(self) -> List[str]:
        """The answer in sentences with numbers."""
        return self._document["summary"]

    @property
    def table(self) -> Table:
        """All models that were tried as columns, the chosen one first: pandas.DataFrame(plan.table)."""
        trials = ([self.chosen] if self.chosen else []) + self._document["rejected"]
        return table_of([{**{k: v for k, v in one.items() if k != "parameters"}, **one["parameters"]} for one in trials])

    def __repr__(self) -> str:
        return f"<limn.Plan: {self._document['summary'][0]}>"


class Judgement(Mapping[str, Any]):
    """A drawing measured against true lines, as `limn judge --json` prints it."""

    def __init__(self, judged: "_limn.Judged") -> None:
        self._judged = judged
        self._document: Dict[str, Any] = json.loads(judged._json())

    def __getitem__(self, name: str) -> Any:
        return self._document[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    @property
    def passed(self) -> bool:
        """No limit is exceeded."""
        return self._judged.passed

    @property
    def text(self) -> str:
        """For people."""
        return self._judged.text

    def report(self) -> str:
        """The page as HTML: the drawing over the lines, and its worst places enlarged."""
        return self._judged._page()

    def junit(self) -> str:
        """The limits as JUnit XML, a test case each."""
        return self._judged._junit()

    def __repr__(self) -> str:
        return f"<limn.Judgement: {'passed' if self.passed else 'failed'}>"
