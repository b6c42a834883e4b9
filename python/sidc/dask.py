"""Work distributed by Dask: tables whose partitions are reduced where they are, and fleets of records.

>>> import dask.dataframe as dd, sidc.dask                                        # doctest: +SKIP
>>> frame = dd.read_parquet("s3://rig/2026/*.parquet")                            # doctest: +SKIP
>>> result = sidc.dask.identify(sidc.read("rig.sid"), frame, holdout=0.1)         # doctest: +SKIP

Work goes to Dask's scheduler: that of a `distributed.Client`, else threads of this process. Work lost with a worker is repeated by the
others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import dask

from . import _sidc
from ._errors import Error
from ._fleet import Fleet, majority
from ._model import Model
from ._options import LOOK_AT, Noise
from ._parts import STRETCHES, Columns, Gathered, Reducer
from ._result import Result

__all__ = ["Fleet", "identify", "identify_each", "identify_fleet"]

GROUP = 8
"""Records of a fleet that are identified together: a result takes seconds, and a group that fails affects few records."""

FAN_IN = 8
"""Parts merged by one task."""

Packed = tuple[str, list[tuple[Columns, "Columns | None"]]]
"""Reduced rows as text, and the kept stretches with held-out ones: what is sent between workers."""


def identify(
    model: Model,
    frame: Any,
    *,
    look_at: int = LOOK_AT,
    holdout: float | None = None,
    noise: Mapping[str, Noise] | None = None,
    params: Mapping[str, float] | None = None,
    horizon: float | None = None,
    good: float | Mapping[str, float] | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
) -> Result:
    """Finds the equations of a Dask DataFrame, one partition at a time on the workers.

    `frame` is a Dask DataFrame, or a list of delayed tables. Everything else is as in `Model.identify_parts`, with partitions as parts.
    """
    options, reducer = model._reducer(look_at, holdout, noise, params, horizon, good)
    partitions = list(frame.to_delayed()) if hasattr(frame, "to_delayed") else list(frame)
    if not partitions:
        raise ValueError("no partitions: give a DataFrame of Dask, or a list of delayed tables")
    every = -(-len(partitions) // STRETCHES)
    reduce, merge = dask.delayed(_reduce), dask.delayed(_merge)
    count = len(partitions)
    level = [reduce(reducer, partition, count, place % every == 0) for place, partition in enumerate(partitions)]
    while len(level) > 1:
        level = [merge(level[first : first + FAN_IN]) for first in range(0, len(level), FAN_IN)]
    (merged,) = dask.compute(level[0])
    if merged is None:
        raise ValueError("no rows: every partition is empty")
    reduced, stretches = merged
    gathered = Gathered(reducer, _sidc.Reduced.from_json(reduced), stretches)
    return model._identify_gathered(gathered, options, params, time_limit, progress)


def identify_each(model: Model, records: Iterable[Any], **options: Any) -> list[Result | Error]:
    """A law for each record, found on the workers. A record is a table, a delayed table, the path of a file that the workers can open, or
    a list of these, which are runs of one system.

    The options are those of `Model.identify`. A record that cannot be identified is represented by its `Error`.
    """
    one = dask.delayed(_identify)
    found = dask.compute(*(one(model, record, options) for record in records))
    return [answer if isinstance(answer, Error) else Result.from_json(answer) for answer in found]


def identify_fleet(model: Model, records: Iterable[Any], *, group: int = GROUP, **options: Any) -> Fleet:
    """One law for all records, found on the workers, by the joint method if readings are noisy.

    Groups of records are identified as runs of one system. The law has the terms found in more than half of the groups. With these terms
    every group is identified again, and each coefficient is the mean over the groups, weighted by inverse variance. It is tested whether
    a coefficient differs between groups by more than its errors. Otherwise groups are treated like records in `identify_each`.
    """
    all_records = list(records)
    if not all_records or group < 1:
        raise ValueError("a fleet has one record at least, and a group one")
    groups = [all_records[first : first + group] for first in range(0, len(all_records), group)]
    narrow = majority(model, identify_each(model, groups, **options))
    return Fleet(narrow, identify_each(narrow, groups, **options))


def _identify(model: Model, record: Any, options: Mapping[str, Any]) -> str | Error:
    try:
        return model.identify(record, progress=False, **options).to_json()
    except Error as error:
        return error


def _reduce(reducer: Reducer, table: Any, parts: int, keeps: bool) -> Packed | None:
    part = reducer.reduce(table, parts, keeps)
    if part is None:
        return None
    return part.reduced.to_json(), [] if part.looked_at is None else [(part.looked_at, part.held_out)]


def _merge(parts: list[Packed | None]) -> Packed | None:
    """Merges in order, so that the same partitions give the same digits. Empty partitions are skipped."""
    filled = [part for part in parts if part is not None]
    if not filled:
        return None
    (first, stretches), *others = filled
    reduced = _sidc.Reduced.from_json(first)
    for other, more in others:
        reduced.merge(_sidc.Reduced.from_json(other))
        stretches = stretches + more
    return reduced.to_json(), stretches
