"""Tables spread over machines by Dask: partitions are reduced where they are, and one answer comes out.

>>> import dask.dataframe as dd, sidc.dask                                        # doctest: +SKIP
>>> frame = dd.read_parquet("s3://rig/2026/*.parquet")                            # doctest: +SKIP
>>> result = sidc.dask.identify(sidc.read("rig.sid"), frame, holdout=0.1)         # doctest: +SKIP

Work goes to the scheduler that Dask has: that of a `distributed.Client`, else threads of this process. What a dead worker had is
done again by the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import dask

from . import _sidc
from ._model import Model
from ._options import Noise
from ._parts import LOOK_AT, STRETCHES, Columns, Gathered, Part, Reducer
from ._result import Result

__all__ = ["identify"]

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
    level = [reduce(reducer, partition, place % every == 0) for place, partition in enumerate(partitions)]
    while len(level) > 1:
        level = [merge(level[first : first + FAN_IN]) for first in range(0, len(level), FAN_IN)]
    ((reduced, stretches),) = dask.compute(level[0])
    gathered = Gathered(_sidc.Reduced.from_json(reduced), stretches)
    return model._identify_gathered(gathered, options, params, time_limit, progress)


def _reduce(reducer: Reducer, table: Any, keeps: bool) -> Packed:
    part: Part = reducer.reduce(table, keeps)
    return part.reduced.to_json(), [] if part.looked_at is None else [(part.looked_at, part.held_out)]


def _merge(parts: list[Packed]) -> Packed:
    """In their order, so that the same partitions give the same digits."""
    (first, stretches), *others = parts
    reduced = _sidc.Reduced.from_json(first)
    for other, more in others:
        reduced.merge(_sidc.Reduced.from_json(other))
        stretches = stretches + more
    return reduced.to_json(), stretches
