"""Parts of the result document in Python: dicts whose entries are also attributes."""

from __future__ import annotations

from typing import Any


class Record(dict[str, Any]):
    """A part of the result document. `record.target` is `record["target"]`, or None if the document lacks it."""

    def __getattr__(self, name: str) -> Any:
        if name in self:
            return self[name]
        if any(name in getattr(kind, "__annotations__", ()) for kind in type(self).__mro__):
            return None
        raise AttributeError(f"{type(self).__name__} has no {name}; it has {', '.join(self)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


class Term(Record):
    """A term of an equation with its coefficient."""

    term: str
    coefficient: float
    unit: str | None
    fixed: bool | None
    standard_error: float | None
    interval: list[float] | None
    stability: float | None
    mark: str | None


class Reason(Record):
    """A reason to distrust an equation, or why it was not found."""

    code: str
    text: str


class Doubt(Reason):
    """A reason with the equation it concerns."""

    target: str


class Equation(Record):
    """target = sum of coefficient * term."""

    target: str
    terms: list[Term]
    status: str
    reasons: list[Reason]
    evidence: Record | None

    @property
    def coefficients(self) -> dict[str, float]:
        """Coefficients by term."""
        return {term.term: term.coefficient for term in self.terms}

    def __str__(self) -> str:
        parts = [f"{term.coefficient:+.6g}*{term.term}" for term in self.terms]
        return f"{self.target} = {' '.join(parts) or '0'}"


class Unknown(Record):
    """An unknown constant with its estimate."""

    name: str
    run: str | None
    value: float
    standard_error: float | None
    interval: list[float] | None


class Prediction(Record):
    """How well the equations predict over a horizon; errors are in the unit of each signal."""

    horizon: float
    unit: str
    starts: int
    fitted_rows: int
    good: bool | None
    signals: list[Record]
    unavailable: Record | None


class Verdict(Record):
    """Whether the equations are the law, how far ahead they predict, and whether they run freely."""

    law: str
    prediction: Prediction
    run: Record


def records(value: Any) -> Any:
    """A value of a document with every object in it as a record."""
    if isinstance(value, dict):
        return Record((key, records(inner)) for key, inner in value.items())
    if isinstance(value, list):
        return [records(inner) for inner in value]
    return value


def equation(document: dict[str, Any]) -> Equation:
    """An equation of a document."""
    found = Equation(records(document))
    found["terms"] = [Term(term) for term in found["terms"]]
    found["reasons"] = [Reason(reason) for reason in found["reasons"]]
    return found


def verdict(document: dict[str, Any]) -> Verdict:
    """The verdict of a document."""
    found = Verdict(records(document))
    found["prediction"] = Prediction(found["prediction"])
    return found
