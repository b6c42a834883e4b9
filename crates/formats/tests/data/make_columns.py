"""Writes the Arrow and HDF5 files beside it: ten rows of t = 0, 0.1, …, x = t², runs a and b, dates every 0.1 s.

Run with pyarrow, polars and h5py installed; the files are kept because tests run where those are not. Nothing in them was recorded: they
are free to use as this repository is.
"""

import h5py
import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.feather as feather

k = np.arange(10)
t = k / 10
x = t**2
run = np.array(["a"] * 5 + ["b"] * 5)
date = np.datetime64("2026-11-25T12:00:00", "us") + k * np.timedelta64(100_000, "us")

table = pa.table({
    "t": pa.array(t),
    "x": pa.array([None, *x[1:]]),
    "count": pa.array(k, type=pa.uint8()),
    "run": pa.array(run).dictionary_encode(),
    "date": pa.array(date),
    "single": pa.array(x.astype("f4")),
    "both": pa.array([{"a": float(v), "b": [v]} for v in x]),
})
for packed in ("lz4", "zstd", "uncompressed"):
    feather.write_feather(table, f"{packed}.feather", compression=packed, chunksize=4)
more = {
    "ok": pa.array(k > 4),
    "large": pa.array(run, type=pa.large_string()),
    "half": pa.array(x.astype("f2")),
    "day": pa.array([None, *range(1, 10)], type=pa.date32()),
    "clock": pa.array((k * 100).astype("i4")).cast(pa.time32("ms")),
    "span": pa.array(k * 10**8, type=pa.duration("ns")),
    "union": pa.UnionArray.from_sparse(pa.array(k % 2, type=pa.int8()), [pa.array(k), pa.array(x)]),
    "bytes": pa.array([b"1"] * 10),
    "nothing": pa.nulls(10),
    "view": pa.array([f"{name}, whose name is long" if place % 2 else name for place, name in enumerate(run)], type=pa.string_view()),
    "maybe": pa.StructArray.from_arrays([pa.array(x)], ["a"], mask=pa.array(k == 3)),
    "pair": pa.FixedSizeListArray.from_arrays(pa.array(np.repeat(x, 2)), 2),
    "runs": pa.RunEndEncodedArray.from_arrays([5, 10], [1.0, 2.0]),
    "t": pa.array(t),
}
with pa.ipc.new_stream("more.arrows", pa.table(more).schema) as stream:
    stream.write_table(pa.table(more), max_chunksize=7)
pl.DataFrame({"t": t, "x": x, "run": run, "count": k.astype("u1"), "kind": pl.Series(run, dtype=pl.Categorical)}).write_ipc("polars.arrow", compression="zstd")


def classed(array, name):
    array.attrs["MATLAB_class"] = np.bytes_(name)
    return array


def mat73(path):
    """As MATLAB's `save -v7.3` writes it: HDF5 behind 512 bytes of its own, rows and columns exchanged."""
    with h5py.File(path, "w", userblock_size=512) as file:
        classed(file.create_dataset("t", data=t[None, :]), "double")
        classed(file.create_dataset("x", data=x[None, :].astype("f4")), "single")
        classed(file.create_dataset("pair", data=np.stack([x, -x]), chunks=(1, 4), compression="gzip", shuffle=True), "double")
        classed(file.create_dataset("ok", data=(t > 0.4)[None, :].astype("u1")), "logical")
        classed(file.create_dataset("n", data=k[None, :].astype("i2")), "int16")
        text = np.frombuffer("a rig".encode("utf-16-le"), np.uint16)[:, None]
        classed(file.create_dataset("note", data=text), "char")
        rig = classed(file.create_group("rig"), "struct")
        classed(rig.create_dataset("t", data=t[None, :]), "double")
        classed(rig.create_dataset("y", data=-x[None, :], chunks=(1, 4), compression="gzip"), "double")
        more = classed(rig.create_group("more"), "struct")
        classed(more.create_dataset("z", data=3 * x[None, :]), "double")
        cell = classed(file.create_group("#refs#").create_dataset("a", data=text), "char")
        classed(file.create_dataset("cells", data=np.array([[cell.ref]], dtype=h5py.ref_dtype)), "cell")
        empty = classed(file.create_dataset("none", data=np.array([0, 0], dtype="u8")), "double")
        empty.attrs["MATLAB_empty"] = np.uint8(1)
        numbers = np.array([(1, 2)] * 10, dtype=[("real", "f8"), ("imag", "f8")])[None, :]
        classed(file.create_dataset("complex", data=numbers), "double")
        classed(file.create_dataset("Ts", data=[[0.1]]), "double")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def hdf5(path):
    with h5py.File(path, "w") as file:
        file["t"], file["x"], file["ok"], file["name"] = t, x, t > 0.4, "rig"


def packed_tightly(path):
    """Ten numbers in a chunk of 32 MB."""
    with h5py.File(path, "w") as file:
        file.create_dataset("x", data=x, chunks=(1 << 22,), maxshape=(None,), compression="gzip", compression_opts=9)


mat73("v73.mat")
hdf5("plain.h5")
packed_tightly("tight.h5")
