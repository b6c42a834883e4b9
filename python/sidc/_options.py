"""Options of a search, checked as on the command line."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Union

from . import _sidc

Span = tuple[Union[float, None], Union[float, None]]
"""The first and last time; None for an open end."""

Noise = Union[float, tuple[float, float]]
"""A standard deviation, or a floor and a share of the value."""

LOOK_AT = 100_000
"""Default number of rows that are kept for the search: as many as are searched of a table in memory with forty terms."""

PROOFS = 60.0
"""Default seconds for proofs of sparsest equations, as for `sidc identify --prove-sparsest`."""


def search_options(
    *,
    noise: Mapping[str, Noise] | None,
    window: Span | None,
    horizon: float | None,
    good: float | Mapping[str, float] | None,
    method: str,
    solver: str | None,
    samples: int | None,
    seed: int,
    robust: bool,
    path: bool,
    prove_sparsest: bool,
    verify: bool,
    memory_limit: int | None,
) -> _sidc.Options:
    """The options of `Model.identify`.

    Raises `Error` for unknown names, ValueError for invalid numbers.
    """
    options = _sidc.Options()
    options.method(method)
    options.seed(_whole("seed", seed, 0))
    if solver is not None:
        options.solver(solver)
    if samples is not None:
        options.samples(_whole("samples", samples, 1), seed)
    if window is not None:
        start, end = window
        options.window(start, end)
    if horizon is not None:
        options.horizon(_positive("horizon", horizon))
    if memory_limit is not None:
        options.memory(_whole("memory_limit", memory_limit, 1))
    for signal, size in (noise or {}).items():
        options.noise(signal, *_noise(signal, size))
    if isinstance(good, Mapping):
        for signal, error in good.items():
            options.good_signal(signal, _positive(f"good of {signal}", error))
    elif good is not None:
        options.good(_positive("good", good))
    for name, wanted in (("robust", robust), ("path", path), ("prove_sparsest", prove_sparsest), ("verify", verify)):
        if wanted:
            getattr(options, name)()
    return options


def _positive(name: str, value: float) -> float:
    if not 0 < value < math.inf:
        raise ValueError(f"{name}: a number above 0, not {value!r}")
    return value


def _whole(name: str, value: int, least: int) -> int:
    if not least <= value < 2**64:
        raise ValueError(f"{name}: a whole number of at least {least}, not {value!r}")
    return value


def _noise(signal: str, size: Noise) -> tuple[float, float]:
    floor, share = size if isinstance(size, (tuple, list)) else (size, 0.0)
    if not (floor >= 0 and share >= 0 and 0 < floor + share < math.inf):
        raise ValueError(f"noise of {signal}: a standard deviation above 0, or a pair (floor, share), not {size!r}")
    return floor, share
