"""Random forced systems behind a lag or a delay: prints the tables of docs/hidden.md, "Lags of forty random systems".

    python3 crates/studies/lags/table.py [target/release/sidc] [--draws 10] [--level 0.001 0.01 0.05] [--place input sensor delay] [--unnamed]

Equations of order 1 and 2 with one or two nonlinear terms, driven by a command that is held between samples. A first-order lag of 10 to 100 ms
is between the command and the equation, or between the state and its sensor; or a smooth command acts 2 to 60 ms late, 0.2 to 6 samples. The model
has the lag with an unknown time constant, or the delay with a range; with --unnamed it has neither, and correct proposals of sidc are counted. An
answer is exact if it has the true terms and no others. Needs Python 3.9, numpy.
"""
import argparse
import functools
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from integration import runge_kutta

STEP = 0.01
TIMES = np.arange(0, 20, STEP)
# Terms of an equation of each order, with their values.
TERMS = {
    1: {"x^2": lambda x, v: x**2, "x^3": lambda x, v: x**3, "sin(x)": lambda x, v: np.sin(x), "x*abs(x)": lambda x, v: x * abs(x)},
    2: {"x^3": lambda x, v: x**3, "x^2": lambda x, v: x**2, "sin(x)": lambda x, v: np.sin(x), "dx*abs(dx)": lambda x, v: v * abs(v),
        "x^2*dx": lambda x, v: x**2 * v},
}
LIBRARY = {1: "1, x, x^2, x^3, sin(x), x*abs(x)", 2: "1, x, x^2, x^3, sin(x), dx, dx^2, dx*abs(dx), x*dx, x^2*dx"}


@functools.cache
def draw(order, place, seed):
    """A law and its noiseless readings: lag, coefficients by term, readings, command."""
    rng = np.random.default_rng([seed, order, ["input", "sensor", "delay"].index(place)])
    while True:
        tau = float(np.exp(rng.uniform(np.log(0.002), np.log(0.06)) if place == "delay" else rng.uniform(np.log(0.01), np.log(0.1))))
        if place == "delay":
            sines = [(rng.normal(0, 0.5), rng.uniform(0.5, 8), rng.uniform(0, 6)) for _ in range(5)]
            command = lambda t: sum(a * np.sin(w * t + p) for a, w, p in sines)
            levels = command(TIMES)
        else:
            levels = np.repeat(rng.uniform(-1, 1, len(TIMES)), rng.integers(10, 60))[: len(TIMES)]
        count = rng.integers(1, 3)
        chosen = list(rng.choice(sorted(TERMS[order]), count, replace=False))
        law = {t: -rng.uniform(0.5, 2) for t in chosen}
        law |= {"x": -rng.uniform(1, 4)} if order == 1 else {"x": -rng.uniform(4, 20), "dx": -rng.uniform(0.3, 2)}
        gain = rng.uniform(3, 8) * (1 if order == 1 else 4)
        values = [(TERMS[order][t], c) for t, c in law.items() if t in TERMS[order]]

        def rates(t, z, u):
            x, v = z[0], z[1] if order == 2 else 0.0
            drive = z[-1] if place == "input" else u
            force = law["x"] * x + law.get("dx", 0) * v + sum(c * f(x, v) for f, c in values) + gain * drive
            own = [force] if order == 1 else [v, force]
            return own if place == "delay" else own + [((u if place == "input" else x) - z[-1]) / tau]

        z = np.zeros(order if place == "delay" else order + 1)
        states = [z]
        for k, t in enumerate(TIMES[:-1]):
            acting = (lambda s: command(s - tau)) if place == "delay" else lambda s: levels[k]
            for s in t + STEP / 5 * np.arange(5):
                z = runge_kutta(lambda s, z: rates(s, z, acting(s)), s, z, STEP / 5)
            if not np.isfinite(z).all() or abs(z[0]) > 10:
                break
            states.append(z)
        if len(states) < len(TIMES):
            continue
        states = np.array(states)
        x, v = states[:, 0], states[:, 1] if order == 2 else 0 * states[:, 0]
        # Laws are drawn again if a term hardly matters, or if others can replace it: no data can show such terms.
        force = np.std(law["x"] * x + gain * levels)
        library = np.column_stack([eval(t.replace("^", "**"), {"x": x, "dx": v, "sin": np.sin, "abs": abs}) * np.ones(len(x)) for t in LIBRARY[order].split(", ")])

        def shows(f, c):
            column = c * f(x, v)
            others = library[:, [not np.allclose(library[:, j] * c, column) for j in range(library.shape[1])]]
            left = column - others @ np.linalg.lstsq(others, column, rcond=None)[0]
            return np.std(left) > 0.02 * force

        if all(shows(f, c) for f, c in values):
            return tau, law | {"u": gain}, states[:, -1] if place == "sensor" else x, levels


def model(order, place, unnamed):
    library = LIBRARY[order]
    target = "d" * order + "x"
    if place == "delay":
        delay = "" if unnamed else ", delay in 0..0.1"
        return f"state x : order {order}\ninput u : linear{delay}\n{target} ~ <{library}, u>\n"
    if unnamed:
        return f"state x : order {order}\ninput u : hold\n{target} ~ <{library}, u>\n"
    if place == "input":
        hidden = "state v : hidden\ndv = (u - v)/tau\n"
        return f"unknown tau in 0.001..10\nstate x : order {order}\ninput u : hold\n{hidden}{target} ~ <{library}, v>\n"
    return f"unknown tau in 0.001..10\nstate y\nstate x : hidden, order {order}\ninput u : hold\ndy = (x - y)/tau\n{target} ~ <{library}, u>\n"


def delay_said(text):
    """The seconds of a sentence such as `u acts 0.028 s (1.4 samples, ...) later than its record`."""
    found = re.search(r"acts? ([0-9.e-]+) s", text)
    return float(found.group(1)) if found else np.nan


def plain(text):
    return re.sub(r"[\s*]|\^1", "", text)


def identify(program, order, place, seed, level, unnamed):
    tau, law, read, u = draw(order, place, seed)
    rng = np.random.default_rng([seed, order, int(1000 * level)])
    read = read + level * np.std(read) * rng.standard_normal(len(read))
    name = "y" if place == "sensor" and not unnamed else "x"
    with tempfile.TemporaryDirectory() as scratch:
        text, data, result = (Path(scratch) / n for n in ("m.sid", "d.csv", "r.json"))
        np.savetxt(data, np.column_stack([TIMES, read, u]), "%.12g", ",", header=f"t,{name},u", comments="")
        text.write_text(model(order, place, unnamed))
        before = os.times()
        run = subprocess.run([program, "identify", "-q", text, data, "-o", result], capture_output=True, text=True)
        seconds = os.times().children_user - before.children_user
        found = json.loads(result.read_text()) if result.exists() else {"equations": []}
        if keep := os.environ.get("KEEP"):
            kept = Path(keep) / f"{place}{order}_{seed}_{level}{'_unnamed' if unnamed else ''}"
            kept.mkdir(parents=True, exist_ok=True)
            for f in (text, data, result):
                f.exists() and (kept / f.name).write_text(f.read_text())
            (kept / "out.txt").write_text(f"tau {tau}, {law}\n{run.stdout}\n{run.stderr}")
    searched = [e for e in found["equations"] if not e["target"] in ("dv", "dy")]
    got = {plain(t["term"]) for e in searched for t in e["terms"]}
    truth = {plain(t) for t in law}
    got = {"u" if t == "v" else t for t in got}
    value = next((v for v in found.get("unknowns", []) + found.get("delays", [])), None)
    low, high = (value or {}).get("interval") or (np.nan, np.nan)
    exact = got == truth
    codes = [r["code"] for e in found["equations"] for r in e["reasons"]]
    passed = bool(found["equations"]) and not codes and not found.get("failed")
    code = "input-delay" if place == "delay" else "missing-state"
    said = next((r["text"] for e in found["equations"] for r in e["reasons"] if r["code"] == code), "")
    proposed = "later" in said and abs(delay_said(said) / tau - 1) < 0.05 if place == "delay" else "lag" in said
    return {"exact": exact, "within": exact and low <= tau <= high, "passed": exact and passed, "wrong": passed and not exact,
            "proposed": proposed, "seconds": seconds,
            "said": f"{place} {order} seed {seed}: tau {tau:.3g}, found {value and (value.get('value', value.get('seconds')), value.get('interval'))}: {sorted(got)} for {sorted(truth)} {codes} {said[:400]}"}


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--draws", type=int, default=10)
    p.add_argument("--level", type=float, nargs="*", default=[0.001, 0.01, 0.05])
    p.add_argument("--place", nargs="*", default=["input", "sensor"])
    p.add_argument("--order", type=int, nargs="*", default=[1, 2])
    p.add_argument("--first", type=int, default=0)
    p.add_argument("--unnamed", action="store_true")
    a = p.parse_args()
    print("| noise | lag or delay of | exact | of these, the time in its interval | of these, passed | wrong and passed | proposed | median seconds |\n|---|---|---|---|---|---|---|---|")
    missed = []
    for level in a.level:
        for place in a.place:
            seeds = range(a.first, a.first + a.draws)
            runs = [identify(a.program, o, place, s, level, a.unnamed) for o in a.order for s in seeds]
            count = lambda key: sum(r[key] for r in runs)
            print(f"| {100 * level:g} % | {place} | {count('exact')} of {len(runs)} | {count('within')} | {count('passed')} | {count('wrong')} | "
                  f"{count('proposed')} | {np.median([r['seconds'] for r in runs]):.2f} |", flush=True)
            missed += [f"{100 * level:g} % {r['said']}" for r in runs if a.unnamed or not r["within"]]
    print("\n".join(missed))


if __name__ == "__main__":
    main()
