"""Random laws with one unknown constant: prints the table of docs/odebench.md, "Random laws".

    python3 crates/studies/families/table.py [target/release/sidc] [--draws 10] [--level 0 0.01 0.05] [--only Hill] [--large]

Eight families in equations of order 1 and 2, driven by an input that is linear between its samples. The constant is drawn from two decades.
It is drawn again if a cubic in x explains its term to 3 %, since then no data can show it. An answer is exact if it has the true terms and
no others. `--large` offers 90 or 210 candidates in place of 6 or 9. Where it is not, the true terms are also offered alone: the last column counts answers that these describe better, by sidc's criterion. Needs Python
3.9, numpy, scipy.
"""
import argparse
import functools
import re
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from identified import identified
from integration import runge_kutta

# Term, its value, lower bound of x, sign of its coefficient. In equations of order 2, a term that needs x > 0 drives x up.
FAMILIES = {
    "Michaelis-Menten": ("x/(k + x)", lambda x, t, k: x / (k + x), 0.05, -1),
    "Hill": ("x^3/(k^3 + x^3)", lambda x, t, k: x**3 / (k**3 + x**3), 0.05, 1),
    "saturation": ("tanh(x/k)", lambda x, t, k: np.tanh(x / k), -np.inf, -1),
    "exponential": ("exp(-k*x)", lambda x, t, k: np.exp(-k * x), 0.05, 1),
    "sine": ("sin(k*t)", lambda x, t, k: np.sin(k * t), -np.inf, -1),
    "Ricker": ("x*exp(-k*x)", lambda x, t, k: x * np.exp(-k * x), 0.05, -1),
    "bell": ("exp(-(x/k)^2)", lambda x, t, k: np.exp(-((x / k) ** 2)), -np.inf, -1),
    "Arrhenius": ("exp(-k/x)", lambda x, t, k: np.exp(-k / x), 0.2, 1),
}
TIMES = np.arange(0, 40, 0.05)


def trajectory(rates, start):
    """States at TIMES, to 1e-9: steps of 1/40 sample, since a step of solve_ivp across a bend of the input errs by 1e-5."""
    z = np.array(start)
    out = [z]
    for t, after in zip(TIMES, TIMES[1:]):
        h = (after - t) / 40
        for s in t + h * np.arange(40):
            z = runge_kutta(rates, s, z, h)
        out.append(z)
    return np.array(out).T


@functools.cache
def draw(family, order, seed):
    """A law and its motion: constant, coefficients by term, x, u."""
    term, f, least, sign = FAMILIES[family]
    rng = np.random.default_rng([seed, order, list(FAMILIES).index(family)])
    while True:
        k = float(np.exp(rng.uniform(np.log(0.1), np.log(10))))
        sign = 1 if order == 2 and least > 0 else sign
        c, damping = sign * rng.uniform(0.8, 2.5), rng.uniform(0.3, 1.2)
        slow, fast = rng.uniform(0.5, 1), rng.uniform(1.3, 2.5)
        offset = 0 if least == -np.inf else 1.2
        u = offset + 0.9 * np.sin(slow * TIMES) + 0.6 * np.sin(fast * TIMES + 1)
        at = lambda t: np.interp(t, TIMES, u)
        law = {term: c, "u": 1.0} | ({"x": -damping} if order == 1 else {"dx": -damping, "x": -0.8})
        rates = {
            1: lambda t, z: [c * f(z[0], t, k) - damping * z[0] + at(t)],
            2: lambda t, z: [z[1], c * f(z[0], t, k) - damping * z[1] - 0.8 * z[0] + at(t)],
        }[order]
        run = solve_ivp(rates, (0, 40), [1.0, 0.0][:order], t_eval=TIMES, max_step=0.05, rtol=1e-9, atol=1e-11)
        if not run.success or not np.isfinite(run.y).all() or abs(run.y).max() > 30 or run.y[0].min() < least:
            continue
        x = run.y[0]
        column, others = f(x, TIMES, k), np.column_stack([np.vander(x, 4), u])
        left = column - others @ np.linalg.lstsq(others, column, rcond=None)[0]
        if np.std(left) > 0.03 * np.std(column):
            return k, law, trajectory(rates, run.y[:, 0])[0], u


def run(program, order, library, columns):
    """The result with these candidates, and seconds of processor time."""
    text = f"unknown k in 0.02..50\nstate x : order {order}\ninput u : linear\n{'d' * order}x ~ {library}\n"
    found, seconds, _ = identified(program, text, columns)
    return found, seconds


def library(family, order, large):
    """Candidates in the language of models."""
    term = FAMILIES[family][0]
    if large:
        return f"poly({'x, dx, u' if order == 2 else 'x, u'}; 4) * <1, {term}> * <1, sin x, cos x>"
    motion = ["dx", "dx^2", "x*dx"] if order == 2 else []
    return f"<{', '.join(['1', 'x', 'x^2', 'x^3', 'u', *motion, term])}>"


def same_law(terms, law, k):
    """Whether as many terms as the law has give its right side for some coefficients: x^2/(k + x) and x do for x/(k + x) and x."""
    rng = np.random.default_rng(0)
    at = {"x": rng.uniform(0.3, 2, 50), "dx": rng.normal(size=50), "u": rng.normal(size=50), "t": rng.uniform(0.1, 3, 50), "k": k}
    functions = {"exp": np.exp, "tanh": np.tanh, "sin": np.sin, "cos": np.cos}
    column = lambda term: eval(term.replace("^", "**"), functions, at) * np.ones(50)
    columns, side = np.column_stack([column(t) for t in terms]), sum(c * column(t) for t, c in law.items())
    left = side - columns @ np.linalg.lstsq(columns, side, rcond=None)[0]
    return len(terms) == len(law) and np.linalg.norm(left) < 1e-8 * np.linalg.norm(side)


def criterion(found, rows):
    """Twice the negative log likelihood of the joint estimate with the price of each term and of k; None without one."""
    fitted = [e["evidence"]["together"] for e in found["equations"] if "together" in e.get("evidence", {})]
    if not fitted:
        return None
    parameters = len(found["equations"][0]["terms"]) + len(found.get("unknowns", []))
    return 2 * rows * np.log(fitted[0]["channels"][0]["left"]) + parameters * fitted[0]["price"]


def identify(program, family, order, seed, level, large):
    k, law, x, u = draw(family, order, seed)
    rng = np.random.default_rng([seed, order, int(1000 * level)])
    read = x + level * np.std(x) * rng.standard_normal(len(x))
    columns = {"t": TIMES, "x": read, "u": u}
    found, seconds = run(program, order, library(family, order, large), columns)
    equations = found["equations"]
    plain = lambda t: re.sub(r"[\s*]|\^1", "", t)
    terms = [t["term"] for e in equations for t in e["terms"]]
    got = {plain(t) for t in terms}
    exact = bool(terms) and same_law(terms, law, k)
    value = next((v for v in found.get("unknowns", [])), None)
    low, high = (value or {}).get("interval") or (np.nan, np.nan)
    near = value is not None and abs(value["value"] / k - 1) < 1e-3
    passed = bool(equations) and all(e["status"] == "pass" for e in equations)
    better = False
    if not exact:
        alone, _ = run(program, order, f"<{', '.join(law)}>", columns)
        here, true = (criterion(f, len(read)) for f in (found, alone))
        whole = sum(len(e["terms"]) for e in alone["equations"]) == len(law)
        better = here is None or whole and true is not None and true < here
    return {"exact": exact, "better": better, "within": exact and (low <= k <= high or (level == 0 and near)), "wrong": passed and not exact, "seconds": seconds,
            "said": f"k {k:.3g}, found {value and value['value']}: {sorted(got)}"}


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--draws", type=int, default=10)
    p.add_argument("--level", type=float, nargs="*", default=[0, 0.01, 0.05])
    p.add_argument("--only", nargs="*", default=list(FAMILIES))
    p.add_argument("--large", action="store_true")
    a = p.parse_args()
    for level in a.level:
        print(f"{100 * level:g} % noise\n| term | exact | k in its interval | wrong and passed | median seconds | true terms are better |\n|---|---|---|---|---|---|")
        rows = {f: [identify(a.program, f, o, s, level, a.large) for o in (1, 2) for s in range(a.draws)] for f in a.only}
        for family, runs in [*rows.items(), ("all", sum(rows.values(), []))]:
            count = lambda key: sum(bool(r[key]) for r in runs)
            term = f"`{FAMILIES[family][0]}`" if family in FAMILIES else "all"
            print(f"| {term} | {count('exact')} of {len(runs)} | {count('within')} of {count('exact')} | {count('wrong')} | {np.median([r['seconds'] for r in runs]):.2f} | {count('better')} |", flush=True)
        for family, runs in rows.items():
            for r in runs:
                if not r["exact"]:
                    marks = ("passes, " if r["wrong"] else "") + ("true terms are better, " if r["better"] else "")
                    print(f"    {family}: {marks}{r['said']}", flush=True)


if __name__ == "__main__":
    main()
