#!/usr/bin/env python3
"""A finished recording as h5py and VTK read it: the same positions, bit for bit, at every time step; a recording
that is being written as a SWMR reader sees it; and readers that must notice a file that is wrong.

usage: recording_readers.py RECORD_LOOP RECORD_READ [CASE...]     (interpreter: one with h5py, numpy and vtk >= 9.4)"""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from patience import patience

BOTH = "both"
READ = os.path.abspath(sys.argv[2])


def value(frame, system, field, count):
    """record_scene.h, value(): what element i of a field must be."""
    return ((frame * 131 + system * 17 + field * 5 + np.arange(count)) % 65521) * 0.25


def opened(path):
    """A reader that knows the file, and the times of its frames."""
    reader = vtk.vtkHDFReader()
    assert reader.CanReadFile(str(path)), "VTK cannot read the file"
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader, reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or [0.0]


def parts_of(reader, frames):
    """The parts of the step that the reader stands at, without the empty block `Steps` that is last in a collection of several frames."""
    reader.Update()
    out = reader.GetOutputDataObject(0)
    if not out.IsA("vtkPartitionedDataSetCollection"):
        return [out]
    count = out.GetNumberOfPartitionedDataSets()
    for k in range(count):
        assert out.GetNumberOfPartitions(k) == 1, f"block {k} has {out.GetNumberOfPartitions(k)} partitions"
    parts = [out.GetPartition(k, 0) for k in range(count)]
    if frames > 1:
        assert parts.pop().GetNumberOfPoints() == 0, "the last block is not empty"
        for part in parts:
            assert part.GetFieldData().GetArray("Time"), "a block has no time"
    return parts


def vtk_blocks(path):
    """Opens with VTK and yields (time, [(points, {array: values}, verts, lines, polys)]) per step, the first as it is after the information."""
    reader, times = opened(path)
    for step, t in enumerate(times):
        if step > 0:
            reader.SetStep(step)
        parts = parts_of(reader, len(times))
        yield t, [(points_of(p), arrays_of(p), p.GetNumberOfVerts(), p.GetNumberOfLines(), p.GetNumberOfPolys()) for p in parts]


def points_of(poly):
    return vtk_to_numpy(poly.GetPoints().GetData()).copy() if poly.GetNumberOfPoints() else np.zeros((0, 3))


def arrays_of(poly):
    data = poly.GetPointData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).copy() for i in range(data.GetNumberOfArrays())}


def compare(path, systems):
    """Every position and array of every step: h5py's equal VTK's. Returns the number of numbers compared."""
    compared = 0
    with h5py.File(path, "r") as f:
        clock = f["clock/time"][:]
        steps = 0
        for i, (t, blocks) in enumerate(vtk_blocks(path)):
            steps += 1
            assert t == clock[i], f"time of step {i}"
            assert len(blocks) == len(systems), f"{len(blocks)} blocks"
            for name, (points, arrays, *_) in zip(systems, blocks):
                group = f["particles"][name]
                rows = int(group["rows"][i]) if "rows" in group else group["position/value"].shape[1]
                want = group["position/value"][i, :rows]
                assert points.shape == want.shape, f"{name} step {i}: {points.shape} rows"
                assert rows == 0 or points.dtype == want.dtype
                assert points.astype(want.dtype).tobytes() == want.tobytes(), f"{name} step {i}: positions differ"
                compared += want.size
                for field in (k for k in group if k not in ("box", "rows", "position")):
                    want = group[field]["value"][i, :rows]
                    assert rows == 0 or arrays[field].tobytes() == want.tobytes(), f"{name}.{field} step {i}"
                    compared += want.size
        assert steps == len(clock), "number of steps"
    return compared


def record(loop, folder, points, frames, kind=BOTH):
    path = Path(folder) / f"{kind}{points}x{frames}.vtkhdf"
    subprocess.run([loop, path, str(points), str(frames), kind], check=True, stdout=subprocess.DEVNULL)
    return path


def case_multi(loop, folder):
    for points, frames in ((100, 131), (20000, 9), (150000, 3)):
        path = record(loop, folder, points, frames)
        print("multi", points, compare(path, ["cloth", "sparks"]), "numbers")
        *_, (_, blocks) = vtk_blocks(path)
        assert blocks[0][2:] == (0, 2, 1), "cloth: two lines, one triangle, no vertices"
        assert blocks[1][2:] == (len(blocks[1][0]), 0, 0), "sparks: vertices only"


def case_single(loop, folder):
    for kind, name in (("fixed", "cloth"), ("variable", "sparks")):
        for points, frames in ((100, 131), (20000, 9)):
            path = record(loop, folder, points, frames, kind)
            print(kind, points, compare(path, [name]), "numbers")


def image_of(data):
    """(origin, spacing, {array: values}) of a VTK image, whatever its data belongs to."""
    cells = data.GetCellData().GetNumberOfArrays() > 0
    holder = data.GetCellData() if cells else data.GetPointData()
    arrays = {holder.GetArrayName(i): vtk_to_numpy(holder.GetArray(i)).copy() for i in range(holder.GetNumberOfArrays())}
    return data.GetOrigin(), data.GetSpacing(), cells, arrays


def case_grids(loop, folder):
    """Images: in the VTKHDF group without a copy, and exported; every number, and where it lies."""
    for frames in (7, 1):
        images(record(loop, folder, 40, frames, "grids"), folder, frames)


def images(path, folder, frames):
    places = {"plate": ((1, 2, 0), (0.5, 0.25, 1), False), "block": ((-0.5, -1, -1.5), (1, 2, 3), True),
              "rod": ((1, 2, 3), (0.5, 1, 1), False)}
    subprocess.run([READ, path, "export", "vti", Path(folder) / "out"], check=True, stdout=subprocess.DEVNULL)
    with h5py.File(path, "r") as f:
        assert f["VTKHDF/plate/PointData/value"].is_virtual, "no data is copied"
        assert list(f["grids/plate"].attrs["counts"]) == [40, 3, 1] and f["grids/block"].attrs["centring"] == b"cells"
        reader, times = opened(path)
        assert len(times) == frames and list(times) == list(f["clock/time"][:])
        # The step 0 before others and after them.
        for step in [*range(frames), 0]:
            if reader.GetStep() != step:
                reader.SetStep(step)
            parts = parts_of(reader, frames)
            assert len(parts) == 3
            for k, name in enumerate(places):
                exported = vtk.vtkXMLImageDataReader()
                exported.SetFileName(str(Path(folder) / f"out.{name}.{step:06}.vti"))
                exported.Update()
                for image in (parts[k], exported.GetOutput()):
                    origin, spacing, cells, arrays = image_of(image)
                    assert (origin, spacing, cells) == places[name], (name, origin, spacing, cells)
                    for field in ("value", "flux"):
                        want = f["grids"][name][field]["value"][step]
                        assert arrays[field].shape == want.shape, (name, field, arrays[field].shape, want.shape)
                        assert arrays[field].tobytes() == want.tobytes(), f"{name}.{field} step {step}"
    print("grids: every number of", len(times), "steps")


def case_h5md(loop, folder):
    """The layout that H5MD asks for, and what the values must be."""
    path = record(loop, folder, 100, 70)
    with h5py.File(path, "r") as f:
        assert list(f["h5md"].attrs["version"]) == [1, 1]
        assert f["h5md/creator"].attrs["name"] == b"truestep"
        assert f["h5md/author"].attrs["name"]
        for n, (name, fields) in enumerate((("cloth", ["position", "velocity"]), ("sparks", ["position", "age", "id"]))):
            group = f["particles"][name]
            assert group["box"].attrs["dimension"] == 3
            assert [b.decode() for b in group["box"].attrs["boundary"]] == ["none"] * 3
            for k, field in enumerate(fields):
                element = group[field]
                assert element["step"] == f["clock/step"] and element["time"] == f["clock/time"], "hard links"
                assert element["value"].fletcher32 and element["value"].compression is None
                assert "unit" not in element["value"].attrs
                rows = int(group["rows"][50]) if n else 100
                want = value(50, n, k, rows * (element["value"].shape[2] if element["value"].ndim == 3 else 1))
                assert np.array_equal(element["value"][50, :rows].ravel(), want.astype(element["value"].dtype)), field
                if n and field != "id":
                    assert np.isnan(element["value"][50, rows:]).all(), "absent rows are NaN"
        assert group["position/value"].attrs["si_unit"] == b"m"
        assert f["observables/energy.kinetic/value"].shape == (70,)
        assert f["observables/energy.kinetic/value"][3] == value(3, 9, 0, 1)[0]
        assert b"schema_version" in f["parameters/scene"][()]
        assert f["parameters/seed"][()] == 7 and f["parameters/dt"][()] == 0.004
        assert f["parameters/journal"][()] == b"[]"
        cloth = f["VTKHDF/cloth"]
        assert cloth["Points"].is_virtual and cloth["PointData/velocity"].is_virtual, "no data is copied"
        assert np.array_equal(f["connectivity/cloth/triangles"][:], [[0, 1, 2]])


def case_swmr(loop, folder):
    """Frames appear while the recorder runs, each right when it appears."""
    path = Path(folder) / "live.vtkhdf"
    process = subprocess.Popen([loop, path, "20000"], stdout=subprocess.PIPE, text=True)
    try:
        acknowledged = int(process.stdout.readline())
        with h5py.File(path, "r", swmr=True) as f:
            step, x, rows = f["clock/step"], f["particles/sparks/position/value"], f["particles/sparks/rows"]
            seen = []
            until = time.monotonic() + patience(20)
            while len(seen) < 4 and time.monotonic() < until:
                for d in (step, rows, x):
                    d.refresh()
                n = len(step)
                if seen and n == seen[-1]:
                    continue
                assert n >= acknowledged and len(x) >= n, "an acknowledged frame is not there"
                count = int(rows[n - 1])
                assert np.array_equal(x[n - 1, :count].ravel(), value(n - 1, 1, 0, 3 * count)), f"frame {n - 1}"
                seen.append(n)
            assert len(seen) == 4 and seen == sorted(seen), seen
            print("swmr: lengths seen while writing", seen)
    finally:
        process.kill()
        process.wait()


def case_export(loop, folder):
    """csv, npz, ply and vtu hold the numbers of the recording."""
    path = record(loop, folder, 50, 6)
    stem = Path(folder) / "out"
    def export(name):
        done = subprocess.run([READ, path, "export", name, stem], check=True, capture_output=True, text=True)
        return done.stdout.split()
    with h5py.File(path, "r") as f:
        x, rows = f["particles/sparks/position/value"][:], f["particles/sparks/rows"][:]
        v = f["particles/cloth/velocity/value"][:]
        files = export("csv")
        assert len(files) == 3, files
        table = np.genfromtxt(f"{stem}.sparks.csv", delimiter=",", names=True)
        assert len(table) == rows.sum()
        want = np.concatenate([x[i, :n] for i, n in enumerate(rows)])
        for c in range(3):
            assert np.array_equal(table[f"position_{c}"], want[:, c])
        assert np.genfromtxt(f"{stem}.observables.csv", delimiter=",", skip_header=1).shape == (6, 4)

        export("npz")
        with np.load(f"{stem}.npz") as z:  # checks every CRC
            assert np.array_equal(z["sparks.position"], x, equal_nan=True)
            assert np.array_equal(z["cloth.velocity"], v) and np.array_equal(z["sparks.rows"], rows)
            assert np.array_equal(z["time"], f["clock/time"][:])
            assert np.array_equal(z["cloth.triangles"], [[0, 1, 2]])

        assert len(export("vtu")) == 13
        grid = vtk.vtkXMLUnstructuredGridReader()
        for i in range(6):
            grid.SetFileName(f"{stem}.sparks.{i:06}.vtu")
            grid.Update()
            out = grid.GetOutput()
            assert out.GetNumberOfPoints() == out.GetNumberOfCells() == rows[i]
            if rows[i]:
                assert np.array_equal(points_of(out), x[i, :rows[i]])
                assert np.array_equal(arrays_of(out)["id"], f["particles/sparks/id/value"][i, :rows[i]])

        assert len(export("ply")) == 12
        ply = vtk.vtkPLYReader()
        ply.SetFileName(f"{stem}.cloth.000003.ply")
        ply.Update()
        assert np.array_equal(points_of(ply.GetOutput()), f["particles/cloth/position/value"][3])
        assert ply.GetOutput().GetNumberOfPolys() == 1


def case_controls(loop, folder):
    """Wrong files must fail the same comparison."""
    def fails(damage, systems, kind=BOTH):
        path = record(loop, folder, 100, 60, kind)
        with h5py.File(path, "r+") as f:
            damage(f)
        try:
            compare(path, systems)
        except (AssertionError, OSError, KeyError, RuntimeError):
            return
        raise SystemExit(f"control {damage.__name__} passed")

    def shifted_points(f):
        f["VTKHDF/cloth/Steps/PointOffsets"][5] = 100 * 6

    def one_bit(f):
        flat = f["VTKHDF/sparks/Points"][:]
        flat[100 * 7, 0] += 1e-12
        del f["VTKHDF/sparks/Points"]
        f["VTKHDF/sparks/Points"] = flat

    def fewer_rows(f):
        f["VTKHDF/NumberOfPoints"][9] += 1

    def other_time(f):
        f["VTKHDF/Steps/Values"][3] += 1e-9

    fails(shifted_points, ["cloth", "sparks"])
    fails(one_bit, ["cloth", "sparks"])
    fails(fewer_rows, ["sparks"], "variable")
    fails(other_time, ["cloth"], "fixed")
    print("controls: 4 wrong files noticed")


def main():
    loop = os.path.abspath(sys.argv[1])
    cases = {k[5:]: v for k, v in globals().items() if k.startswith("case_")}
    for name in sys.argv[3:] or cases:
        with tempfile.TemporaryDirectory() as folder:
            cases[name](loop, folder)
            print(name, "ok")


main()
