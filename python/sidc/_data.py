"""Tables as the records of one system."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from . import _sidc, _tables
from ._errors import Error


class Measured:
    """Records in the order in which they were given: files keep their names, other tables are called `run 1`, `run 2`, …"""

    def __init__(self) -> None:
        self.native = _sidc.Data()
        self._tables: list[Any] = []
        self._notes: list[str] = []

    @staticmethod
    def of(data: Any, params: Mapping[str, float | Sequence[float]] | None = None) -> Measured:
        """The tables of one or several runs; a Measured is returned unchanged."""
        if isinstance(data, Measured):
            return data
        measured = Measured()
        tables = _tables.runs(data)
        if not tables:
            raise ValueError("no table: give one, or a list of them")
        for table in tables:
            measured.add(table)
        for name, values in (params or {}).items():
            several = values if isinstance(values, Sequence) else [values]
            measured.native.param(name, [float(value) for value in several])
        return measured

    def add(self, table: Any) -> int:
        """Adds a table. Returns its index."""
        place = len(self._tables)
        if isinstance(table, (str, os.PathLike)):
            self._add_file(table)
        else:
            self._add_columns(f"run {place + 1}", table)
        self._tables.append(table)
        return place

    def _add_file(self, path: str | os.PathLike[str]) -> None:
        name = os.path.basename(os.fspath(path))
        known = len(self.native.notes())
        with open(path, "rb") as file:
            self.native.file(name, file.read())
        for note in self.native.notes()[known:]:
            # Attributed to the caller of a method of a model or a result.
            warnings.warn(note, stacklevel=5)

    def _add_columns(self, name: str, table: Any) -> None:
        columns, others = _tables.columns(table)
        self._notes += [f"the column {other} of {name} holds no numbers" for other in others]
        self.native.run(name, columns)

    def hold_out(self, options: _sidc.Options, held: Any) -> None:
        """Sets in the options what is held out; tables that are not yet records are added."""
        if held is None:
            return
        if isinstance(held, list):
            for one in held:
                self.hold_out(options, one)
        elif isinstance(held, (int, float)):
            if not 0 < held < 1:
                raise ValueError(f"holdout: the last part of every record is between 0 and 1, not {held}")
            options.hold_out_last(float(held))
        elif isinstance(held, tuple):
            start, end = held
            options.hold_out_times(start, end)
        else:
            known = [place for place, table in enumerate(self._tables) if table is held]
            options.hold_out_run(known[0] if known else self.add(held))

    @contextmanager
    def explained(self) -> Iterator[None]:
        """Adds to errors of the data which columns were ignored because they hold no numbers."""
        try:
            yield
        except Error as error:
            all_notes = self._notes + self.native.notes()
            if error.kind != "data" or not all_notes:
                raise
            notes = "".join(f"\n  = note: {note}" for note in all_notes)
            raise Error(f"{error}{notes}", error.kind, error.codes) from None
