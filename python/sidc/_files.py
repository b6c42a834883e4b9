"""Files that another package reads for us: MATLAB's `-v7.3` (h5py).

In: a path. Out: a table and what of the file is none of its columns; None where the compiled code reads the file itself.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

Read = tuple[Any, list[str]]
"""A table, and notes."""

NUMBERS = {b"double", b"single", b"logical", *(f"{sign}int{bits}".encode() for sign in ("", "u") for bits in (8, 16, 32, 64))}
"""Classes of MATLAB whose values are numbers."""


def foreign(path: str | os.PathLike[str]) -> Read | None:
    """The table in a file of another package's format, by its first bytes."""
    with open(path, "rb") as file:
        start = file.read(16)
    for magic, package, read in KINDS:
        if start.startswith(magic):
            return _by(package, read, path)
    return None


def _by(package: str, read: Callable[[Any, Any], Read], path: str | os.PathLike[str]) -> Read:
    name = os.path.basename(os.fspath(path))
    try:
        reader = import_module(package)
    except ImportError:
        needed = package.partition(".")[0]
        text = f"{name} is read by {needed}, which is not installed\n  = help: pip install {needed}, or export the data as CSV"
        raise Error(f"error[not-text]: {text}", "data", ["not-text"]) from None
    try:
        return read(reader, path)
    except (OSError, ValueError, KeyError) as fault:
        text = f"error[damaged-file]: {name}: {fault}\n  = help: copy the file anew, or write it again"
        raise Error(text, "data", ["damaged-file"]) from None


def _hdf5(h5py: Any, path: Any) -> Read:
    with h5py.File(path, "r") as file:
        found = dict(_variables(h5py, file))
    lengths = Counter(max(values.shape) for values in found.values() if values.size > 1)
    if not lengths:
        raise ValueError("no array of numbers in it has a name")
    rows = max(lengths, key=lambda length: (lengths[length], length))
    columns: dict[str, NDArray[Any]] = {}
    notes = []
    for name, values in found.items():
        if rows not in values.shape or values.ndim > 2:
            notes.append(f"not read as a column: {name} (of shape {values.shape})")
            continue
        # Of several columns each has the number that it has in MATLAB.
        along = values if values.shape[-1] == rows else values.T
        several = along.reshape(-1, rows)
        for place, column in enumerate(several):
            columns[name if len(several) == 1 else f"{name}_{place + 1}"] = column
    return columns, notes


def _variables(h5py: Any, group: Any, inside: str = "", taken: set[str] | None = None) -> Iterator[tuple[str, NDArray[Any]]]:
    """Every array of numbers by its name; a field by its own name, or after that of its structure where another has that."""
    taken = set() if taken is None else taken
    folders = []
    for name, item in group.items():
        if isinstance(item, h5py.Group):
            if not name.startswith("#"):
                folders.append((name, item))
        elif item.attrs.get("MATLAB_class", b"double") in NUMBERS and "MATLAB_empty" not in item.attrs and item.dtype.kind in "fiub":
            own = name if name not in taken else f"{inside}_{name}"
            taken.add(own)
            yield own, item[()]
    for name, item in folders:
        yield from _variables(h5py, item, name, taken)


KINDS: list[tuple[bytes, str, Callable[[Any, Any], Read]]] = [
    (b"MATLAB 7.3", "h5py", _hdf5),
    (b"\x89HDF", "h5py", _hdf5),
]
"""First bytes, the package, how it reads."""
