"""One law for many records: results from groups of records are combined.

In: a model, the results of groups of records. Out: the terms found in most groups, and coefficients pooled over all groups by inverse
variance. Finds no equation itself.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ._model import Model
from ._result import Result

MAJORITY = 0.5
"""Share of the groups in which a term must be found: the median probability model (Barbieri & Berger 2004, Ann. Statist. 32, 870)."""

DIFFERS = 1e-3
"""Groups differ if this significance level, divided by the number of coefficients, is undercut."""

NORMAL = 1.959964
"""Half-width of a 95 % interval in standard errors."""


@dataclass(frozen=True)
class FleetTerm:
    """A coefficient pooled over all groups."""

    target: str
    term: str
    coefficient: float
    standard_error: float
    """Of the mean, if all records share one value."""
    spread: float
    """Standard deviation of the groups' values beyond their errors (DerSimonian & Laird 1986); 0 if the errors explain it."""
    p: float
    """Probability of differences at least this large if all records share one value (Cochran's Q)."""
    groups: int


class Fleet:
    """The law of a fleet. Its text has the equations, how the groups agree, and the doubts."""

    def __init__(self, model: Model, results: Sequence[Result | Exception]) -> None:
        self.model = model
        """The model with libraries reduced to the terms found in most groups."""
        self.results = list(results)
        """The results of the groups under this model; an error if a group has none."""
        self.terms = list(_joined(self.found))

    @property
    def found(self) -> list[Result]:
        """The results of the groups that have one."""
        return [result for result in self.results if isinstance(result, Result)]

    @property
    def differing(self) -> list[FleetTerm]:
        """Coefficients that differ between groups by more than their errors."""
        return [term for term in self.terms if term.p < DIFFERS / len(self.terms)]

    @property
    def doubts(self) -> Counter[str]:
        """The number of groups with each doubt, by code."""
        return Counter(code for result in self.found for code in {doubt.code for doubt in result.doubts})

    @property
    def passes(self) -> bool:
        """True if every group has a result without doubts, and no coefficient differs between groups."""
        return len(self.found) == len(self.results) > 0 and all(result.passes for result in self.found) and not self.differing

    @property
    def result(self) -> Result:
        """The law for simulation and export: the result of the first group with the pooled coefficients.

        Its evidence is that of the first group alone.
        """
        values = {(term.target, term.term): term for term in self.terms}
        document = json.loads(self.found[0].to_json())
        for equation in document["equations"]:
            for term in equation["terms"]:
                joined = values.get((equation["target"], term["term"]))
                if joined is not None:
                    half = NORMAL * joined.standard_error
                    term["coefficient"], term["standard_error"] = joined.coefficient, joined.standard_error
                    term["interval"] = [joined.coefficient - half, joined.coefficient + half]
        return Result.from_json(json.dumps(document))

    def __str__(self) -> str:
        lines = []
        for target in dict.fromkeys(term.target for term in self.terms):
            own = [term for term in self.terms if term.target == target]
            lines.append(f"{target} = " + " ".join(f"{term.coefficient:+.6g}*{term.term}" for term in own))
        groups = len(self.results)
        lines += ["", f"{'passes' if self.passes else 'doubted'}: {len(self.found)} of {groups} groups have an answer"]
        lines += [
            f"{term.term} of {term.target} differs between the groups: {term.coefficient:.4g} ± {term.spread:.2g} (p {_below(term.p)})"
            for term in self.differing
        ]
        lines += [f"{code}: {count} of {groups} groups" for code, count in self.doubts.most_common()]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<sidc.Fleet of {len(self.results)} groups, {'passes' if self.passes else 'doubted'}>"


def majority(model: Model, results: Iterable[Result | Exception]) -> Model:
    """The model with the terms found in more than half of the results."""
    found = [result for result in results if isinstance(result, Result)]
    if not found:
        raise ValueError("no group of records has an answer: identify one record to see why")
    libraries = {}
    for target in model.targets:
        if model.candidates(target) is None:
            continue
        count = Counter(t.term for result in found for e in result.equations if e.target == target for t in e.terms if not t.fixed)
        libraries[target] = [term for term in model.terms(target) if count[term] > MAJORITY * len(found)]
        if not libraries[target]:
            raise ValueError(f"the groups agree on no term of {target}: identify one record to see why")
    return model.with_terms(libraries)


def _joined(results: Sequence[Result]) -> Iterator[FleetTerm]:
    """Pools every coefficient over the groups that have it with a standard error."""
    values: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for result in results:
        for equation in result.equations:
            for term in equation.terms:
                error = (term.interval[1] - term.interval[0]) / (2 * NORMAL) if term.interval else term.standard_error
                if not term.fixed and error is not None:
                    values.setdefault((equation.target, term.term), []).append((term.coefficient, error))
    for (target, name), pairs in values.items():
        yield _mean(target, name, pairs)


def _mean(target: str, name: str, pairs: Sequence[tuple[float, float]]) -> FleetTerm:
    # An error of 0 would get all the weight.
    least = max(max(abs(value) for value, _ in pairs) * 1e-12, math.ulp(0.0))
    weights = [1 / max(error, least) ** 2 for _, error in pairs]
    total = math.fsum(weights)
    mean = math.fsum(weight * value for weight, (value, _) in zip(weights, pairs)) / total
    q = math.fsum(weight * (value - mean) ** 2 for weight, (value, _) in zip(weights, pairs))
    free = len(pairs) - 1
    scale = total - math.fsum(weight**2 for weight in weights) / total
    between = math.sqrt(max(q - free, 0.0) / scale) if free and scale > 0 else 0.0
    p = chi_squared_tail(q, free) if free else 1.0
    return FleetTerm(target, name, mean, 1 / math.sqrt(total), between, p, len(pairs))


def _below(p: float) -> str:
    return "< 1e-16" if p < 1e-16 else f"= {p:.1g}"


def chi_squared_tail(q: float, free: int) -> float:
    """P(χ² > q), by the cube-root approximation of Wilson & Hilferty (1931)."""
    share = 2 / (9 * free)
    return 0.5 * math.erfc(((q / free) ** (1 / 3) - (1 - share)) / math.sqrt(2 * share))
