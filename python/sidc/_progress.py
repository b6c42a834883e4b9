"""Progress of long work, by tqdm where that is installed and somebody looks: at a terminal or in a notebook."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Any

DELAY = 1.0
"""Seconds of work before a bar is shown, as the program has it: shorter work would only flicker."""


class Progress:
    """A bar over the equations of a model; `wanted` None shows it where somebody looks."""

    def __init__(self, targets: Sequence[str], wanted: bool | None) -> None:
        self._targets = targets
        self._bar: Any = None
        self._make = _tqdm() if wanted or (wanted is None and _is_watched()) else None
        self._show_at = time.monotonic() + (0.0 if wanted else DELAY)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, raised: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()

    @property
    def heard(self) -> Any:
        """What the work calls with the place of an equation and words; None where nothing is shown."""
        return self._show if self._make is not None else None

    def _show(self, place: int, words: str) -> None:
        if self._bar is None:
            if time.monotonic() < self._show_at or self._make is None:
                return
            self._bar = self._make(total=len(self._targets), unit="equation", leave=False)
        done = min(place, len(self._targets))
        name = f"{self._targets[place]}: " if place < len(self._targets) else ""
        self._bar.set_description(name + words, refresh=False)
        self._bar.n = max(self._bar.n, done)
        self._bar.refresh()


def _tqdm() -> Any:
    try:
        import tqdm.auto
    except ImportError:
        return None
    return tqdm.auto.tqdm


def _is_watched() -> bool:
    shell = sys.modules.get("IPython")
    inside = shell.get_ipython() if shell is not None else None
    is_notebook = inside is not None and hasattr(inside, "kernel")
    return is_notebook or bool(sys.stderr and sys.stderr.isatty())
