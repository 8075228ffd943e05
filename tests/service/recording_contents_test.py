"""What a recording holds when nobody says what, and what documents and exports of it are good for: h5py, VTK, MDAnalysis
and meshio of the tests' environment read it, with the lines of docs/recordings.md among others."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from importlib.util import find_spec
from pathlib import Path

import h5py
import numpy as np

from patience import patience

ROOT = Path(__file__).resolve().parents[2]
BINARY = os.environ.get("TRUESTEP_BINARY", str(ROOT / "build" / "release" / "bin" / "truestep"))
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)


def blocks():
    return BLOCK.findall((ROOT / "docs" / "recordings.md").read_text())


def truestep(*arguments, text=None):
    done = subprocess.run([BINARY, *map(str, arguments)], input=text, capture_output=True, text=True, timeout=patience(120))
    if done.returncode:
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr[-600:]}")
    return done.stdout


class Recordings(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def record(self, scene, *arguments):
        path = self.folder / "run.vtkhdf"
        path.unlink(missing_ok=True)
        as_text = scene if isinstance(scene, str) else "-"
        truestep("run", as_text, "--progress", "none", "-o", path, *arguments, text=None if as_text == scene else json.dumps(scene))
        return path

    def test_bodies_and_not_the_room_for_more(self):
        with h5py.File(self.record("mixed_pile", "--steps", 10)) as f:
            x = f["particles/bodies/position/value"]
            self.assertEqual(x.shape, (11, 145, 3))
            self.assertTrue(np.isfinite(x[:]).all())
            # 11 frames of 145 bodies with 32 bytes each; the room for 10,000 more was 1.3 MB.
            self.assertLess(sum(x.id.get_chunk_info(i).size for i in range(x.id.get_num_chunks())), 400_000)

    def test_a_curve_has_its_points_and_not_their_trails(self):
        with h5py.File(self.record("lorenz_butterfly", "--steps", 50)) as f:
            x = f["particles/lorenz/position/value"][:]
            self.assertEqual(x.shape, (51, 2, 3))
            self.assertGreater(np.ptp(x[:, 0], axis=0).max(), 0.1)

    def test_emitted_rows_are_there_when_they_are_emitted(self):
        with h5py.File(self.record("fountain", "--steps", 60)) as f:
            rows, x = f["particles/water/rows"][:], f["particles/water/position/value"]
            self.assertGreater(rows[-1], rows[0])
            self.assertEqual(x.shape[1], max(rows.max(), 1))
            for k in range(len(rows)):
                self.assertEqual(np.isfinite(x[k, :, 0]).sum(), rows[k])

    def test_poses_shapes_energies_and_probes(self):
        scene = {"time": {"dt": 0.01, "duration": 0.2}, "observables": ["energy"], "viewer": {"color_by": "speed"},
                 "probes": [{"id": "tip", "system": "b", "index": 1, "fields": ["velocity"]}],
                 "systems": [{"type": "rigid3d", "id": "b", "bodies": [
                     {"type": "box", "half_extents": [0.1, 0.2, 0.3], "position": [0, 2, 0], "angular_velocity": [0, 0, 3]},
                     {"type": "sphere", "radius": 0.25, "position": [3, 2, 0]}]}]}
        with h5py.File(self.record(scene)) as f:
            self.assertLessEqual({"position", "orientation", "velocity"}, set(f["particles/b"]))
            q = f["particles/b/orientation/value"]
            self.assertEqual(q.attrs["meaning"], b"orientation")
            # 3 rad/s about z for 0.2 s: w = cos(0.3). Single precision, and the step's own error of the turn.
            self.assertAlmostEqual(q[-1, 0, 0], np.cos(0.3), delta=1e-4)
            shapes = f["shapes/b"]
            found = {int(row): (shapes["kind"][s].rstrip(b"\0"), shapes["size"][s].tolist()) for row, s in shapes["instances"][:]}
            self.assertEqual(found[0], (b"box", [0.1, 0.2, 0.3]))
            self.assertEqual((found[1][0], found[1][1][0]), (b"sphere", 0.25))
            # Only energies are named, and the probe is there all the same.
            self.assertEqual({name.split(".")[0] for name in f["observables"]}, {"energy", "tip"})
            self.assertAlmostEqual(f["observables/tip.velocity.y/value"][-1], -9.81 * 0.2, delta=1e-6)

    def test_named_fields_and_no_others(self):
        scene = json.loads(truestep("gallery", "mixed_pile")) | {"recording": {"fields": ["velocity"]}}
        with h5py.File(self.record(scene, "--steps", 2)) as f:
            self.assertEqual(list(f["particles"]), ["bodies"])
            self.assertEqual(set(f["particles/bodies"]) - {"box", "rows"}, {"velocity"})

    def test_obstacles_are_recorded_as_they_move(self):
        with h5py.File(self.record("moving_obstacle", "--seconds", 1)) as f:
            x = f["particles/obstacles/position/value"][:]
            self.assertGreater(np.ptp(x, axis=0).max(), 0.1, "none of them moves")
            self.assertEqual(len(f["shapes/obstacles/kind"]), x.shape[1])

    def test_the_lines_of_the_document(self):
        self.record("rope_bridge_balls", "--seconds", 1)
        self.assertEqual(len(blocks()), 3)
        for block in blocks():
            self.assertLessEqual(block.count("\n"), 7, "about five lines")
            modules = re.findall(r"^import (.*)$", block, re.M)[0].split(", ")
            if missing := [m for m in modules if find_spec(m) is None]:
                print("skipped: not installed:", *missing, file=sys.stderr)
                continue
            self.assertEqual(self.run_lines(block), 0)
            self.assertNotEqual(self.run_lines(block.replace("run.vtkhdf", "ran.vtkhdf")), 0)  # the control

    def run_lines(self, block):
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", block], cwd=self.folder, capture_output=True, text=True, timeout=patience(120))
        self.assertTrue(done.returncode or done.stdout.strip(), "it prints nothing")
        return done.returncode

    @unittest.skipIf(find_spec("meshio") is None, "meshio is not installed")
    def test_exports_make_folders_and_ply_opens_in_meshio(self):
        import meshio
        for scene, part, kind in (("hanging_cloth", "cloth", "triangle"), ("rope_catenary", "rope", "line"), ("newtons_cradle", "balls", None)):
            path = self.record(scene, "--steps", 1)
            stem = self.folder / "new" / scene / "out"
            truestep("export", path, "-o", stem, "--format", "ply")
            mesh = meshio.read(f"{stem}.{part}.000001.ply")
            with h5py.File(path) as f:
                np.testing.assert_array_equal(mesh.points, f[f"particles/{part}/position/value"][1])
                if kind:
                    want = f[f"connectivity/{part}/{kind}s"][:]
                    np.testing.assert_array_equal(np.concatenate([c.data for c in mesh.cells if c.type == kind]), want)


if __name__ == "__main__":
    unittest.main()
