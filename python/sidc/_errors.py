"""The only error of the language and its data."""

from __future__ import annotations


class Error(ValueError):
    """Why there is no result: every fault at once, each with its place, its cause and a remedy.

    The text is what the program prints.
    """

    kind: str
    """Where the fault lies: `model`, `data`, `options`, `document`, `export` or `internal`."""

    codes: list[str]
    """The stable codes of all faults, in the order of the text; docs/diagnostics.md lists them."""

    def __init__(self, text: str, kind: str = "internal", codes: list[str] | None = None) -> None:
        super().__init__(text)
        self.kind = kind
        self.codes = list(codes or [])

    def __reduce__(self) -> tuple[type[Error], tuple[str, str, list[str]]]:
        return Error, (str(self), self.kind, self.codes)
