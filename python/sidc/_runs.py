"""Free runs: signals simulated along a record."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._records import Record

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import NDArray


class Run(dict[str, "NDArray[float64]"]):
    """One record, simulated from its first row under its inputs: time `t`, states, highest derivatives and outputs by name.

    All arrays have the same length, with NaN after the run ended. `pandas.DataFrame(run)` makes it a table.
    """

    name: str
    """The name of the record."""

    measured: dict[str, NDArray[float64]]
    """Readings of the simulated signals at the same times; NaN if missing."""

    scores: list[Record]
    """For each signal that is both simulated and measured: `signal`, `rows` compared, `mse`, `fit` in per cent, `r_squared`."""

    fault: str | None
    """What ended the run early, and where; None if it ran to the end."""

    def __init__(self, simulated: tuple[str, Any, Any, Any, str | None]) -> None:
        self.name, columns, measured, scores, self.fault = simulated
        self.measured = dict(measured)
        super().__init__(columns)
        keys = ("signal", "rows", "mse", "fit", "r_squared")
        self.scores = [Record(zip(keys, score)) for score in scores]

    def __repr__(self) -> str:
        fits = ", ".join(f"{s.signal} {s.fit:.4g} %" for s in self.scores)
        ended = f", ended {self.fault}" if self.fault else ""
        return f"<sidc.Run {self.name}: {', '.join(self)}{f'; fit {fits}' if fits else ''}{ended}>"
