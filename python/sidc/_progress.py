"""Progress of long work, by tqdm if it is installed, at a terminal or in a notebook."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from types import TracebackType
from typing import Any

DELAY = 1.0
"""Seconds of work before a bar is shown, as in the program: for shorter work it would only flicker."""


class Progress:
    """A bar over the equations of a model; `wanted` None shows it at a terminal or in a notebook."""

    def __init__(self, targets: Sequence[str], wanted: bool | None) -> None:
        self._targets = targets
        self._bar: Any = None
        self._shows = _shows(wanted)
        self._show_at = time.monotonic() + (0.0 if wanted else DELAY)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, raised: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()

    @property
    def heard(self) -> Any:
        """The callback of the work, with the index of an equation and words; None if nothing is shown."""
        return self._show if self._shows else None

    def _show(self, place: int, words: str) -> None:
        if self._bar is None:
            if time.monotonic() < self._show_at:
                return
            self._bar = _bar(total=len(self._targets), unit="equation")
        done = min(place, len(self._targets))
        name = f"{self._targets[place]}: " if place < len(self._targets) else ""
        self._bar.set_description(name + words, refresh=False)
        self._bar.n = max(self._bar.n, done)
        self._bar.refresh()


def over_parts(parts: Iterable[Any], count: int | None, wanted: bool | None) -> Iterable[Any]:
    """The parts of a table, with a bar that counts them."""
    if not _shows(wanted):
        return parts
    counted: Iterable[Any] = _bar(parts, total=count, unit="part", delay=0.0 if wanted else DELAY)
    return counted


def _shows(wanted: bool | None) -> bool:
    return (wanted or (wanted is None and _is_watched())) and find_spec("tqdm") is not None


def _bar(*parts: Iterable[Any], **options: Any) -> Any:
    with warnings.catch_warnings():
        # In a notebook without widgets tqdm draws a text bar, and warns about it.
        warnings.simplefilter("ignore")
        import tqdm.auto
    return tqdm.auto.tqdm(*parts, leave=False, **options)


def _is_watched() -> bool:
    shell = sys.modules.get("IPython")
    inside = shell.get_ipython() if shell is not None else None
    is_notebook = inside is not None and hasattr(inside, "kernel")
    return is_notebook or bool(sys.stderr and sys.stderr.isatty())
