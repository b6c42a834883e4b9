"""Writes the files beside it: ten rows of t = 0, 0.1, …, x = t², runs a and b, dates every 0.1 s.

Run with NumPy, SciPy, pyarrow and Octave installed; the files are kept because tests run where those are not.
"""

import subprocess

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

k = np.arange(10)
t = k / 10
x = t**2
run = np.array(["a"] * 5 + ["b"] * 5)
date = np.datetime64("2026-11-25T12:00:00", "ns") + k * np.timedelta64(100_000_000, "ns")
pair = np.column_stack([x, -x])

np.savez("stored.npz", t=t, x=x, run=run, date=date, pair=pair, count=k.astype(">i2"), Ts=0.1, words=np.array(["a", 1], dtype=object))
np.savez_compressed("packed.npz", t=t, half=x.astype("f2"), single=x.astype("f4"), flag=k > 4, pair=np.asfortranarray(pair))
np.savez("timeless.npz", u=x, y=-x, Ts=0.05)
rows = np.zeros(10, dtype=[("t", "f8"), ("x", ">f4"), ("run", "S3"), ("both", "f8", (2,))])
rows["t"], rows["x"], rows["run"] = t, x, run.astype("S3")
np.save("fields.npy", rows)
np.save("nameless.npy", pair)

scipy.io.savemat("scipy.mat", {"t": t, "x": x[:, None], "pair": pair, "n": k.astype("int16"), "run": list(run), "Ts": 0.1, "note": "rig 2", "z": x + 1j})
octave = """
t = (0:9)' / 10; x = t.^2; pair = [x -x]; run = ['aa'; 'aa'; 'aa'; 'aa'; 'aa'; 'b '; 'b '; 'b '; 'b '; 'b '];
data.t = t; data.x = single(x); data.more.x = -x; rig = {'a', 2}; ok = t > 0.4; s = sparse(x);
save('-v7', 'octave7.mat', 't', 'pair', 'run', 'rig', 'ok', 's');
save('-v6', 'octave6.mat', 'data', 'ok');
"""
subprocess.run(["octave-cli", "--quiet", "--eval", octave], check=True)

table = {
    "t": pa.array(t),
    "x": pa.array([None, *x[1:]]),
    "count": pa.array(k, type=pa.uint8()),
    "run": pa.array(run).dictionary_encode(),
    "date": pa.array(date),
    "single": pa.array(x.astype("f4")),
    "both": pa.array([{"a": float(v), "b": [v]} for v in x]),
}
for packed in ("snappy", "zstd", "gzip", "lz4", "none"):
    pq.write_table(pa.table(table), f"{packed}.parquet", compression=packed, row_group_size=4)
