"""Tables of all kinds -> named columns of numbers.

In: a dict of arrays, a structured array, a pandas, polars, pyarrow or dask frame, anything with the Arrow C stream or the
interchange protocol. Out: float64 arrays, with NaN for missing values. Arrays that are already float64 are not copied here.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import NDArray

TIME = "t"
"""The column that models read times from by default."""


def runs(data: Any) -> list[Any]:
    """The tables of one or several runs."""
    return list(data) if isinstance(data, (list, tuple)) else [data]


def columns(table: Any) -> tuple[list[tuple[str, NDArray[float64]]], list[str]]:
    """The numeric columns by name, and the names of the other columns."""
    numbers: list[tuple[str, NDArray[float64]]] = []
    others: list[str] = []
    for name, values in _named(_computed(table)):
        found = _numbers(values)
        if found is None:
            others.append(name)
        else:
            numbers.append((name, found))
    return numbers, others


def _computed(table: Any) -> Any:
    """The table itself; lazy tables (dask, polars) are computed."""
    for ends in ("compute", "collect"):
        # The type is checked, because a lazy polars frame computes its columns when they are accessed.
        if hasattr(type(table), "columns") and hasattr(table, ends):
            return getattr(table, ends)()
    return table


def _named(table: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(table, Mapping):
        return ((str(name), values) for name, values in table.items())
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names:
        return ((name, table[name]) for name in names)
    if hasattr(table, "iloc"):
        return _of_pandas(table)
    if hasattr(table, "column_names") and hasattr(table, "column"):
        return ((str(name), table.column(name)) for name in table.column_names)
    if hasattr(table, "get_column"):
        return ((str(name), table.get_column(name)) for name in table.columns)
    if hasattr(table, "__arrow_c_stream__"):
        return _named(_by_protocol(table, (("pyarrow", "table"), ("polars", "DataFrame"))))
    if hasattr(table, "__dataframe__"):
        routes = (("pyarrow.interchange", "from_dataframe"), ("polars", "from_dataframe"))
        return _named(_by_protocol(table, routes))
    kind = type(table).__name__
    raise TypeError(f"a table is a dict of arrays, a frame (pandas, polars, pyarrow, dask) or the path of a file, not {kind}")


def _by_protocol(table: Any, routes: Sequence[tuple[str, str]]) -> Any:
    """The table in a package that supports its protocol: preferably one already loaded, else one that is installed."""
    import importlib

    ready = sorted(routes, key=lambda route: route[0].partition(".")[0] not in sys.modules)
    for module, function in ready:
        try:
            read: Callable[[Any], Any] = getattr(importlib.import_module(module), function)
        except ImportError:
            continue
        return read(table)
    raise TypeError("a table that offers only a protocol is read by pyarrow or polars: install one of them")


def _of_pandas(frame: Any) -> Iterator[tuple[str, Any]]:
    """The index, if it has times or a name, then the columns."""
    taken = {str(name) for name in frame.columns}
    levels = [frame.index.get_level_values(k) for k in range(frame.index.nlevels)]
    for level in levels:
        is_time = level.dtype.kind in "fmM"
        names = [str(level.name)] if level.name is not None else []
        if len(levels) == 1 and (is_time or names):
            names.append(TIME)
        for name in dict.fromkeys(names):
            if name not in taken:
                taken.add(name)
                yield name, level
    for place, name in enumerate(frame.columns):
        yield str(name), frame.iloc[:, place]


def _numbers(values: Any) -> NDArray[float64] | None:
    """Values as float64, dates and times as seconds from the first; None if they are neither."""
    import numpy as np

    array = _array(values)
    if array.ndim != 1:
        raise ValueError(f"a column has one value for each row, not the shape {array.shape}")
    kind = array.dtype.kind
    if kind in "fiub":
        # Buffers received over a network may be unaligned.
        return np.require(array, np.float64, "A")
    if kind == "M":
        known = array[~np.isnat(array)]
        first = known[0] if len(known) else np.datetime64(0, "s")
        return _seconds(array - first)
    if kind == "m":
        return _seconds(array)
    for dtype in ("float64", "datetime64[us]") if kind == "O" else ():
        try:
            return _numbers(array.astype(dtype))
        except (TypeError, ValueError):
            continue
    return None


def _array(values: Any) -> NDArray[Any]:
    import numpy as np

    kind = getattr(getattr(values, "dtype", None), "kind", "")
    if hasattr(values, "array") and kind in tuple("fiub"):
        # A pandas series; NumPy has no missing integers.
        return np.asarray(values.to_numpy(dtype="float64", na_value=np.nan))
    if hasattr(values, "array") and kind == "M":
        # With or without a time zone.
        return np.asarray(values.to_numpy(dtype="datetime64[ns]"))
    if hasattr(values, "combine_chunks"):
        return np.asarray(values.to_numpy())
    if isinstance(values, np.ma.MaskedArray):
        return _unmasked(values)
    return np.asarray(values.to_numpy() if hasattr(values, "to_numpy") else values)


def _unmasked(values: Any) -> NDArray[Any]:
    """Replaces masked values by NaN, NaT or None."""
    import numpy as np

    kind = values.dtype.kind
    if kind in "mM":
        return np.asarray(values.filled(np.array("NaT", values.dtype)))
    return np.asarray(values.astype(np.float64).filled(np.nan) if kind in "fiub" else values.astype(object).filled(None))


def times(values: Any) -> NDArray[float64]:
    """Times as numbers; dates as seconds from the first."""
    found = _numbers(values)
    if found is None:
        raise TypeError("times are numbers, dates or time spans")
    return found


def matrix(values: Any) -> NDArray[float64]:
    """An array with rows of numbers and a column for each signal; NaN for missing values."""
    import numpy as np

    if hasattr(values, "toarray"):
        raise TypeError("a sparse matrix is no measurement: give X.toarray()")
    array = np.asarray(_unmasked(values) if isinstance(values, np.ma.MaskedArray) else values)
    if np.iscomplexobj(array):
        raise ValueError("Complex data not supported: give real and imaginary parts as columns of their own")
    array = array.astype(np.float64, copy=False)
    return array[:, None] if array.ndim == 1 else array


def index_times(table: Any) -> NDArray[float64] | None:
    """The times in the index of a pandas frame, if it has any."""
    index: Any = getattr(table, "index", None)
    is_time = hasattr(table, "iloc") and getattr(index, "nlevels", 2) == 1 and index.dtype.kind in "fmM"
    return times(index) if is_time else None


def _seconds(spans: NDArray[Any]) -> NDArray[float64]:
    import numpy as np

    return np.asarray(spans / np.timedelta64(1, "s"), dtype=np.float64)
