"""Runs the program on a model and a table, for the studies that draw their records. Needs numpy."""
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np


def identified(program, model, columns):
    """The result document of a model's text and columns by name, its seconds of processor time, and what was said on stderr."""
    with tempfile.TemporaryDirectory() as scratch:
        text, data, result = (Path(scratch) / n for n in ("m.sid", "d.csv", "r.json"))
        np.savetxt(data, np.column_stack(list(columns.values())), "%.12g", ",", header=",".join(columns), comments="")
        text.write_text(model)
        before = os.times()
        run = subprocess.run([program, "identify", "-q", text, data, "-o", result], capture_output=True, text=True)
        seconds = os.times().children_user - before.children_user
        found = json.loads(result.read_text()) if result.exists() else {"equations": []}
    return found, seconds, run.stderr
