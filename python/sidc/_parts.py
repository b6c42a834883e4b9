"""Tables larger than memory: parts, one after another -> reduced rows, and stretches that are searched.

In: the parts of a table. Out: what least squares needs from all rows, and some of the rows. Nothing else of a part is kept, so memory
does not grow with the number of parts.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Sized
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _sidc, _tables
from ._data import Measured
from ._options import Noise, search_options

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import NDArray

Columns = list[tuple[str, "NDArray[float64]"]]
"""Names with values."""

STRETCHES = 32
"""Largest number of stretches that rows are kept from; at least half as many if there are enough parts."""

BATCH = 1 << 17
"""Rows per part of a file: about ten megabytes."""


@dataclass
class Part:
    """What is kept of a part."""

    reduced: _sidc.Reduced
    looked_at: Columns | None
    held_out: Columns | None


@dataclass
class Reducer:
    """Reduces parts under a model. It can be sent to another process, and its results are sent back as `Packed`."""

    text: str
    name: str
    noise: Mapping[str, Noise] | None
    params: Mapping[str, float] | None
    look_at: int
    """Total number of rows kept for the search."""
    holdout: float
    """The held-out fraction of these, at the end of each stretch."""

    @staticmethod
    def of(
        text: str, name: str, look_at: int, holdout: float | None, noise: Mapping[str, Noise] | None, params: Mapping[str, float] | None
    ) -> Reducer:
        """A reducer that keeps this many rows in total, with this fraction held out."""
        if not look_at >= STRETCHES:
            raise ValueError(f"look_at: at least {STRETCHES} rows, not {look_at!r}")
        if holdout is not None and not 0 < holdout < 1:
            raise ValueError(f"holdout: a part between 0 and 1, not {holdout!r}")
        return Reducer(text, name, noise, params, look_at, holdout or 0.0)

    def share(self, parts: int, rows: int) -> tuple[int, int]:
        """How many of the first rows of a part, one of `parts`, are searched, and how many after them are held out."""
        kept = min(rows, self.look_at // min(parts, STRETCHES))
        held = round(kept * self.holdout)
        return kept - held, held

    def reduce(self, table: Any, parts: int, keeps: bool = True) -> Part | None:
        """Reduces a part, one of `parts`; if `keeps`, its first rows are kept for the search. None for a part without rows."""
        columns, _ = _tables.columns(table)
        rows = _length(columns)
        if columns and rows == 0:
            return None
        if not keeps:
            return Part(self._reduced([columns]), None, None)
        ahead, held = self.share(parts, rows)
        behind = ahead + held
        looked_at, held_out = _rows(columns, 0, ahead), _rows(columns, ahead, behind)
        # Rows without a gap must stay one record.
        used = [looked_at, [(name, values[behind:]) for name, values in columns]] if held else [columns]
        return Part(self._reduced([run for run in used if _length(run)]), looked_at, held_out if behind > ahead else None)

    def _reduced(self, runs: list[Columns]) -> _sidc.Reduced:
        model = _sidc.Model(self.text, self.name)
        return model.reduce(measured(runs, self.params).native, self.options())

    def options(self, horizon: float | None = None, good: float | Mapping[str, float] | None = None) -> _sidc.Options:
        """The options of its regression; predictions are made for the whole, not for a part."""
        return search_options(
            noise=self.noise, window=None, horizon=horizon, good=good, method="regression", solver=None, samples=None, seed=0, robust=False,
            path=False, prove_sparsest=False, verify=False, memory_limit=None,
        )  # fmt: skip


class Gathered:
    """The parts of a table so far. Parts must be added in order, so that the same parts give the same bytes."""

    def __init__(
        self, reducer: Reducer, reduced: _sidc.Reduced | None = None, stretches: Sequence[tuple[Columns, Columns | None]] = ()
    ) -> None:
        self.reduced = reduced
        self._reducer = reducer
        self.stretches = list(stretches)
        self._every = 1
        self._parts = 0

    def add(self, part: Part | None) -> None:
        """Adds a part; one without rows changes nothing."""
        if part is None:
            return
        if self.reduced is None:
            self.reduced = part.reduced
        else:
            self.reduced.merge(part.reduced)
        if part.looked_at is not None and self._parts % self._every == 0:
            self._keep(part.looked_at, part.held_out)
        self._parts += 1

    def _keep(self, looked_at: Columns, held_out: Columns | None) -> None:
        self.stretches.append((looked_at, held_out))
        if len(self.stretches) > STRETCHES:
            self.stretches = self.stretches[::2]
            self._every *= 2
        # The first parts kept more than their final share.
        self.stretches = [self._trimmed(used, held) for used, held in self.stretches]

    def _trimmed(self, used: Columns, held: Columns | None) -> tuple[Columns, Columns | None]:
        ahead, behind = self._reducer.share(len(self.stretches), _length(used) + _length(held or []))
        return _rows(used, 0, ahead), held and _rows(held, 0, behind)

    def looked_at(self, options: _sidc.Options, params: Mapping[str, float] | None) -> Measured:
        """The kept stretches as records; held-out ones are set in the options."""
        data = measured([used for used, _ in self.stretches], params)
        for _, held in self.stretches:
            if held is not None:
                data.hold_out(options, dict(held))
        return data


def measured(runs: Sequence[Columns], params: Mapping[str, float] | None) -> Measured:
    """Columns as records."""
    return Measured.of([dict(run) for run in runs], params)


@dataclass
class Parts:
    """The parts of a source, one after another."""

    tables: Iterable[Any]
    count: int | None
    """The number of parts, if it is known."""

    @staticmethod
    def of(source: Any) -> Parts:
        """The batches of a Parquet file, or the tables from an iterable."""
        if isinstance(source, (str, os.PathLike)):
            return _batches(source)
        if isinstance(source, Iterable) and not isinstance(source, Mapping):
            return Parts(source, len(source) if isinstance(source, Sized) else None)
        kind = type(source).__name__
        raise TypeError(f"parts are the path of a Parquet file or tables one after another, not {kind}; a table in memory is for `identify`")


def gather(reducer: Reducer, parts: Iterable[Any]) -> Gathered:
    """Reduces the parts on all cores, a few at a time."""
    cores = os.cpu_count() or 1
    gathered = Gathered(reducer)
    waiting: deque[Future[Part | None]] = deque()
    pool = ThreadPoolExecutor(cores)
    try:
        for place, part in enumerate(parts):
            waiting.append(pool.submit(reducer.reduce, part, place + 1))
            if len(waiting) > cores:
                gathered.add(waiting.popleft().result())
        while waiting:
            gathered.add(waiting.popleft().result())
    finally:
        # After Ctrl-C the parts in progress are not waited for.
        pool.shutdown(wait=False, cancel_futures=True)
    return gathered


def _batches(path: str | os.PathLike[str]) -> Parts:
    try:
        from pyarrow.parquet import ParquetFile
    except ImportError:
        raise ImportError("the parts of a Parquet file are read by pyarrow: install it, or give tables one after another") from None
    import pyarrow

    try:
        file = ParquetFile(path)
    except pyarrow.ArrowInvalid as error:
        raise ValueError(f"{os.fspath(path)} is no Parquet file that pyarrow reads: {error}") from None

    def tables() -> Iterator[Any]:
        with file:
            for batch in file.iter_batches(batch_size=BATCH):
                yield pyarrow.Table.from_batches([batch])

    return Parts(tables(), -(-file.metadata.num_rows // BATCH))


def _rows(columns: Columns, start: int, end: int) -> Columns:
    # A copy, because a view would keep the whole part.
    return [(name, values[start:end].copy()) for name, values in columns]


def _length(columns: Columns) -> int:
    return len(columns[0][1]) if columns else 0
