"""Results of identification."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _records, _sidc
from ._data import Measured
from ._records import Doubt, Equation, Prediction, Record, Unknown, Verdict
from ._report import Report
from ._right_side import Function
from ._runs import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Result:
    """The equations of a system with their evidence.

    str() gives the answer that the program prints; a notebook shows equations, verdict and coefficients typeset.
    """

    def __init__(self, native: _sidc.Discovery, measured: Measured | None = None) -> None:
        self._native = native
        self._measured = measured

    @staticmethod
    def from_json(text: str) -> Result:
        """Reads a result document, from `to_json` or `sidc identify -o`."""
        return Result(_sidc.Discovery.from_json(text))

    def to_json(self) -> str:
        """The result document (docs/command-line.md) that the program writes; arrays are not files and have no hash."""
        return self._native.to_json()

    @cached_property
    def document(self) -> Record:
        """The complete result document."""
        document: Record = _records.records(json.loads(self.to_json()))
        return document

    @property
    def passes(self) -> bool:
        """True if every equation was found and none has a doubt."""
        return self._native.passes()

    @cached_property
    def equations(self) -> list[Equation]:
        """The equations found and those that the model states, in the model's order."""
        return [_records.equation(entry) for entry in self.document["equations"]]

    @cached_property
    def failed(self) -> list[Record]:
        """The equations that were asked for but not found: `target` and `reasons`."""
        return list(self.document["failed"])

    @cached_property
    def doubts(self) -> list[Doubt]:
        """Every reason to distrust an equation, or why it was not found."""
        all_equations = [*self.failed, *self.equations]
        return [Doubt(reason, target=e["target"]) for e in all_equations for reason in e["reasons"]]

    @cached_property
    def verdict(self) -> Verdict | None:
        """Whether the equations are the law, how far ahead they predict, and whether they run freely; None in documents of earlier versions."""
        found = self.document.get("verdict")
        return None if found is None else _records.verdict(found)

    @cached_property
    def unknowns(self) -> list[Unknown]:
        """The unknown constants of the model with their estimates."""
        return [Unknown(entry) for entry in self.document.get("unknowns", [])]

    def simulate(
        self,
        data: Any,
        *,
        start: Mapping[str, float] | None = None,
        params: Mapping[str, Any] | None = None,
        time_limit: float | None = None,
    ) -> Any:
        """Runs the equations along a table from its first row, under its inputs. Returns a `Run`, or a list of them for a list of tables.

        `start` gives initial values by name; if all are given, a table of times and inputs suffices. Raises `Error` if data are missing
        that a run needs. A run that ends early is not an error: see `Run.fault`.
        """
        measured = Measured.of(data, params)
        with measured.explained():
            values = [(name, float(value)) for name, value in (start or {}).items()]
            runs = [Run(run) for run in self._native.simulate(measured.native, values, time_limit)]
        return runs if isinstance(data, (list, tuple, Measured)) else runs[0]

    def score(self, data: Any, *, horizon: float | None = None, params: Mapping[str, Any] | None = None) -> Prediction:
        """How well the equations predict `horizon` seconds (samples in discrete time) ahead along these data.

        Each start has a state fitted to the readings before it. For each signal, `signals` has its `error` at the horizon (`rms`, and
        `quantile_90`, the bound for 90 % of the starts), that of keeping the value constant (`no_change`), and that of a linear model
        fitted to these data (`linear`). Without a horizon the data decide.
        """
        measured = Measured.of(data, params)
        with measured.explained():
            found = json.loads(self._native.predict(measured.native, horizon))
        # Only the caller knows whether these data were used for identification.
        found.pop("on", None)
        return Prediction(_records.records(found))

    def export(self, target: str) -> str:
        """The equations in another language, by the names in `sidc list`: `rust`, `c`, `python`, `casadi`, `modelica`, …"""
        return self._native.export(target)

    def export_bytes(self, target: str) -> bytes:
        """As the bytes of a file, also for binary targets such as `fmi`: `Path("pendulum.fmu").write_bytes(result.export_bytes("fmi"))`."""
        return self._native.export_bytes(target)

    def function(self) -> Function:
        """The equations as a function for `scipy.integrate.solve_ivp`, with its Jacobian."""
        return Function(self._native)

    def to_sympy(self) -> list[Any]:
        """The equations as found: a `sympy.Eq` for each derivative, next value or output."""
        import sympy

        names: dict[str, Any] = {}
        exec(self.export("sympy"), names)  # noqa: S102 - code that this package wrote
        sides = list(zip(names["unknown"], names.get("right", [])))
        outputs = [e.target for e in self.equations][len(sides) :]
        sides += [(sympy.Symbol(name, real=True), value) for name, value in zip(outputs, names.get("outputs", []))]
        return [sympy.Eq(left, right, evaluate=False) for left, right in sides]

    def report(self, path: str | os.PathLike[str] | None = None, data: Any = None) -> Report:
        """The result as a page of HTML, with runs along `data`, by default the data that the equations were found from.

        Written to `path` if one is given; a notebook shows it in a frame.
        """
        page = Report(self._native.report(self._along(data).native))
        if path is not None:
            page.write(path)
        return page

    def plot(self, data: Any = None) -> Figure:
        """Plots measurements and simulation along `data`, by default the data that the equations were found from; needs matplotlib."""
        from ._plots import measured_against_simulated

        return measured_against_simulated(self.simulate(self._along(data)))

    def _along(self, data: Any) -> Measured:
        if data is not None:
            return Measured.of(data)
        if self._measured is None:
            raise ValueError("a result that was read from a document has no data of its own: give them")
        return self._measured

    def __str__(self) -> str:
        return self._native.answer().rstrip("\n")

    def __repr__(self) -> str:
        state = "passes" if self.passes else "doubted" if not self.failed else "not all found"
        return f"<sidc.Result, {state}:\n{self._native.equations()}>"

    def _repr_html_(self) -> str:
        return self._native.html()

    def _repr_latex_(self) -> str:
        lines = re.search(r"\\begin\{align\*\}\n(.*?)\\end\{align\*\}", self.export("latex"), re.DOTALL)
        inside = lines.group(1) if lines else ""
        return f"$$\\begin{{aligned}}\n{inside}\\end{{aligned}}$$"

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return Result.from_json, (self.to_json(),)
