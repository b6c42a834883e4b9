"""Prints the table of docs/rigs.md: one row for each measured set.

    python3 crates/studies/rigs/table.py FOLDER [target/release/sidc] [--only NAME]

FOLDER holds the measured sets, which are not part of this project (docs/rigs.md says where they come from). Each model in this folder is
identified on three quarters of its record, or on one whole record of two, and tested on what was held out. Needs Python 3.8.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Model, data, held-out part, horizon (in the time unit of the record).
RIGS = [
    ("pendulum_single", "pendulum_single_free_train.csv", "25%", "0.5"),
    ("pendulum_double", "pendulum_double_free_train.csv", "25%", "0.2"),
    ("aeroshield", "aeroshield_pendulum.csv", "25%", "0.5"),
    ("aeroshield_order3", "aeroshield_pendulum.csv", "25%", "0.5"),
    ("aeroshield_fan", "aeroshield_pendulum.csv", "25%", "0.5"),
    ("silverbox", "silverbox_multisine_excerpt.csv", "25%", "0.02"),
    ("tanks", "tanks_cascaded_est.csv", "25%", "40"),
    ("tanks_cascade", "tanks_cascaded_est.csv", "25%", "40"),
    ("emps", "emps_train.csv", "25%", "0.5"),
    ("emps", "emps_train.csv", "25%", "2"),
    ("cartpole", "cartpole_swingup_A.csv", "cartpole_swingup_B.csv", "0.26"),
    ("rlc", "rlc_nonlinear_train.csv", "25%", "2e-5"),
    ("rlc_saturating", "rlc_nonlinear_train.csv", "25%", "2e-5"),
    ("tclab", "tclab_train.csv", "25%", "60"),
    ("tclab_order2", "tclab_train.csv", "25%", "60"),
    ("tclab_heater", "tclab_train.csv", "25%", "60"),
    ("floatshield", "floatshield.csv", "25%", "0.5"),
    ("lynx_hare", "bio_lynx_hare_1900_1920.csv", "25%", "2"),
]


def number(x):
    return "–" if x is None else f"{x:.2g}"


def row(program, folder, model, data, held, horizon):
    held_out = held if held.endswith("%") else str(folder / held)
    with tempfile.TemporaryDirectory() as scratch:
        result = Path(scratch) / "result.json"
        asked = [f"--holdout={held_out}", f"--horizon={horizon}", "--good=10%"]
        before = os.times()
        run = subprocess.run(
            [program, "identify", "-q", HERE / f"{model}.sid", folder / data, *asked, "-o", result],
            capture_output=True, text=True,
        )
        after = os.times()
        seconds = after.children_user - before.children_user
        if not result.exists():
            return f"| {model} | status {run.returncode} | | | | | | |"
        found = json.loads(result.read_text())
    verdict, equations = found["verdict"], found["equations"]
    prediction = verdict["prediction"]
    shown = [s for s in prediction["signals"] if not s["signal"].startswith("d")]
    column = lambda key: ", ".join(number((s.get(key) or {}).get("quantile_90")) for s in shown)
    terms = lambda e: ", ".join(f"{t['coefficient']:.4g} {t['term']}" for t in e["terms"])
    laws = "; ".join(f"{e['target']}: {terms(e)}" for e in equations)
    laws += "".join(f"; {u['name']} = {u['value']:.4g}" for u in found.get("unknowns", []))
    codes = list(dict.fromkeys(r["code"] for e in equations + found["failed"] for r in e["reasons"]))
    step = " ".join(w for w in run.stdout.rsplit("next: ", 1)[-1].split() if w != "\\")
    for part in (f"-o {result} ", "-q ", f"{folder}/", f"{HERE}/", f"{scratch}/"):
        step = step.replace(part, "")
    ended = sum(e["starts"] for e in prediction.get("ended", []))
    starts = f"{prediction['starts'] - ended} of {prediction['starts']}" if ended else str(prediction["starts"])
    names = ", ".join(f"{s['signal']} {number(s['error'].get('quantile_90'))} {s.get('unit', '')}".strip() for s in shown)
    cells = [
        model, f"`{laws}`", f"{horizon} {prediction['unit']}: {names}", column("no_change"), column("linear"), starts,
        "yes" if prediction.get("good") else "no", verdict["run"]["status"],
        ", ".join(f"`{c}`" for c in codes), f"`{step}`" if "~" in step or step.startswith("sidc") else step, f"{seconds:.2g}",
    ]
    return "| " + " | ".join(c.replace("|", "\\|") for c in cells) + " |"


def main():
    arguments = sys.argv[1:]
    only = None
    if "--only" in arguments:
        place = arguments.index("--only")
        only = arguments[place + 1]
        del arguments[place:place + 2]
    if not arguments:
        sys.exit(__doc__)
    folder = Path(arguments[0])
    program = arguments[1] if len(arguments) > 1 else "target/release/sidc"
    print("| model | found | ahead: error | no change | linear | starts | good | free run | doubts | what to do next | s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for rig in RIGS:
        if only in (None, rig[0]):
            print(row(program, folder, *rig), flush=True)


main()
