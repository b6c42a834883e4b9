"""Prints the table of docs/odebench.md: the 63 systems of ODEBench, identified from their states alone.

    python3 crates/studies/odebench/table.py [target/release/sidc] [--level 0 0.01 0.05] [--draws 3] [--only 14 22] [--csv FILE]

Each system is read 501 times in ten seconds from both of its starts. Noise is relative to each state's standard deviation. A run is exact
if every equation has the true terms and no others. Needs Python 3.9, numpy, scipy.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from systems import LIBRARIES, SYSTEMS

TIMES = np.linspace(0, 10, 501)
FUNCTIONS = {k: getattr(np, k) for k in ("sin", "cos", "exp", "log", "abs", "sign", "tanh")}


def value(term, names):
    """A term's value. Terms are in Python syntax except for the sign of powers."""
    with np.errstate(all="ignore"):
        return eval(term.replace("^", "**"), {"__builtins__": {}}, {**FUNCTIONS, **names})


def motion(system, start):
    laws = [[(compile(t.replace("^", "**"), t, "eval"), c) for t, c in law.items()] for law in system["laws"]]

    def rates(_, x):
        names = {**FUNCTIONS, **system["constants"], **{f"x{i}": v for i, v in enumerate(x)}}
        return [sum(c * eval(t, {"__builtins__": {}}, names) for t, c in law) for law in laws]

    run = solve_ivp(rates, (0, 10), start, "LSODA", TIMES, rtol=1e-11, atol=1e-12)
    return run.y.T


def model(system):
    states = ", ".join(f"x{i}" for i in range(len(system["laws"])))
    declared, library = LIBRARIES[system["library"]].split("|")
    declared = [d.strip() for d in declared.split(";") if d.strip()]
    rates = ", ".join(f"dx{i}" for i in range(len(system["laws"])))
    return "\n".join([*declared, f"state {states}", f"{rates} ~ {library.strip().replace('S', states)}", ""])


def fingerprint(term, points):
    """Values that identify a term, however it is written."""
    values = [value(term, p) for p in points]
    return tuple(f"{float(v):.8e}" for v in values)


def points(system):
    rng = np.random.default_rng(1)
    names = [f"x{i}" for i in range(len(system["laws"]))]
    return [{n: rng.uniform(0.3, 0.9) for n in [*names, *system["constants"]]} for _ in range(6)]


def exact(system, found):
    at = points(system)
    laws = {e["target"]: {fingerprint(t["term"], at) for t in e["terms"]} for e in found["equations"]}
    truth = [{fingerprint(t, at) for t in law} for law in system["laws"]]
    return all(laws.get(f"dx{i}") == law for i, law in enumerate(truth))


def within(system, found):
    """How many constants of an exact answer are in their intervals (without noise: or right to 0.1 %), and how many constants there are.

    With a constant term in the library, a logistic function may have all its signs reversed: 1/(1 + exp(z)) = 1 - 1/(1 + exp(-z)).
    """

    def held(sign):
        count = 0
        for u in found.get("unknowns", []):
            true, interval = sign * system["constants"][u["name"]], u.get("interval")
            count += bool(interval and interval[0] <= true <= interval[1]) or abs(u["value"] / true - 1) < 1e-3
        return count

    mirrored = system["library"] == "logistic function"
    return max(held(1), held(-1) if mirrored else 0), len(system["constants"])


def identify(program, system, tables):
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        (scratch / "model.sid").write_text(model(system))
        files = []
        for k, table in enumerate(tables):
            names = ",".join(["t", *(f"x{i}" for i in range(table.shape[1]))])
            files.append(scratch / f"start{k}.csv")
            np.savetxt(files[-1], np.column_stack([TIMES, table]), "%.12g", ",", header=names, comments="")
        before = os.times()
        command = [program, "identify", "-q", scratch / "model.sid", *files, "-o", scratch / "result.json"]
        run = subprocess.run(command, capture_output=True, text=True)
        after = os.times()
        seconds = after.children_user - before.children_user
        if not (scratch / "result.json").exists():
            return None, seconds, run.stderr.strip()
        return json.loads((scratch / "result.json").read_text()), seconds, run.stderr.strip()


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--level", type=float, nargs="*", default=[0, 0.01, 0.05])
    p.add_argument("--draws", type=int, default=3)
    p.add_argument("--only", type=int, nargs="*")
    p.add_argument("--csv")
    a = p.parse_args()
    rows = []
    for system in SYSTEMS:
        if a.only and system["number"] not in a.only:
            continue
        clean = [motion(system, start) for start in system["starts"]]
        size = np.vstack(clean).std(0)
        for level in a.level:
            for draw in range(a.draws if level else 1):
                rng = np.random.default_rng([system["number"], draw, int(1000 * level)])
                tables = [x + level * size * rng.standard_normal(x.shape) for x in clean]
                found, seconds, said = identify(a.program, system, tables)
                row = {"system": system["number"], "library": system["library"], "noise": level, "draw": draw, "seconds": f"{seconds:.2f}"}
                equations = found["equations"] if found else []
                row["exact"] = bool(found) and exact(system, found)
                row["within"], row["constants"] = within(system, found) if row["exact"] else (0, len(system["constants"]))
                row["passed"] = bool(equations) and len(equations) == len(system["laws"]) and all(e["status"] == "pass" for e in equations)
                row["found"] = "; ".join(e["target"] + ": " + " + ".join(f"{t['coefficient']:.4g} {t['term']}" for t in e["terms"]) for e in equations)
                row["unknowns"] = ", ".join(f"{u['name']}={u['value']:.4g}" for u in found.get("unknowns", [])) if found else said[:200]
                row["codes"] = " ".join(sorted({r["code"] for e in equations for r in e["reasons"]}))
                rows.append(row)
                mark = "exact" if row["exact"] else "     "
                print(f"{row['system']:2d} {level:4.2f} {draw} {mark} {'pass' if row['passed'] else 'doubt'} {row['within']}/{row['constants']} {seconds:5.1f} s  "
                      + ("" if row["exact"] else f"{row['found'][:230]} | {row['unknowns']} | {row['codes']}"), flush=True)
    for level in a.level:
        own = [r for r in rows if r["noise"] == level]
        wrong = sum(r["passed"] and not r["exact"] for r in own)
        held, of = (sum(r[k] for r in own if r["exact"]) for k in ("within", "constants"))
        print(f"{100 * level:g} %: exact {sum(r['exact'] for r in own)} of {len(own)}, wrong and passed {wrong}, constants in their intervals {held} of {of}")
    if a.csv:
        with open(a.csv, "w", newline="") as f:
            out = csv.DictWriter(f, rows[0].keys())
            out.writeheader()
            out.writerows(rows)


if __name__ == "__main__":
    sys.exit(main())
