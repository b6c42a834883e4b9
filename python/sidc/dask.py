"""Work spread over machines by Dask: tables whose partitions are reduced where they are, and fleets of records.

>>> import dask.dataframe as dd, sidc.dask                                        # doctest: +SKIP
>>> frame = dd.read_parquet("s3://rig/2026/*.parquet")                            # doctest: +SKIP
>>> result = sidc.dask.identify(sidc.read("rig.sid"), frame, holdout=0.1)         # doctest: +SKIP

Work goes to the scheduler that Dask has: that of a `distributed.Client`, else threads of this process. What a dead worker had is
done again by the others.
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
"""Records of a fleet that are identified together: one answer takes seconds, and a group that cannot be followed spoils little."""

FAN_IN = 8
"""Parts merged by one task."""

Packed = tuple[str, list[tuple[Columns, "Columns | None"]]]
"""Reduced rows as text, and stretches looked at closely with those held out: what goes from worker to worker."""


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
    """Finds the equations of a Dask DataFrame, a partition at a time on the workers.

    `frame` is a DataFrame of Dask, or a list of delayed tables. Everything else is as in `Model.identify_parts`: partitions are the parts.
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
    """A law for each record, on the workers. A record is a table, a delayed one, the path of a file that the workers can open, or a
    list of these, which are runs of one system.

    The options are those of `Model.identify`. A record that cannot be identified has the `Error` that says why in its place.
    """
    one = dask.delayed(_identify)
    found = dask.compute(*(one(model, record, options) for record in records))
    return [answer if isinstance(answer, Error) else Result.from_json(answer) for answer in found]


def identify_fleet(model: Model, records: Iterable[Any], *, group: int = GROUP, **options: Any) -> Fleet:
    """One law for all records, on the workers, with the joint method where readings are noisy.

    Groups of records are identified as the runs of one system. The terms that more than half of the groups found are the law's; with
    these alone every group is identified again, and each coefficient is the mean of the groups, weighted by inverse variance. Whether
    it differs between them by more than its errors is tested. What holds for `identify_each` holds for the groups.
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
    """In their order, so that the same partitions give the same digits. Those without rows are left out."""
    filled = [part for part in parts if part is not None]
    if not filled:
        return None
    (first, stretches), *others = filled
    reduced = _sidc.Reduced.from_json(first)
    for other, more in others:
        reduced.merge(_sidc.Reduced.from_json(other))
        stretches = stretches + more
    return reduced.to_json(), stretches
