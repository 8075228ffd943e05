"""truestep check as its users call it: folders, filters, exit codes, one line per failure."""
import json
import os
import subprocess
import tempfile
import unittest

from harness import BINARY
from patience import patience

FALLING = {"gravity": [0, -9.81, 0], "time": {"dt": 0.01, "duration": 1},
           "systems": [{"type": "rigid3d", "id": "a", "bodies": [{"type": "sphere", "radius": 0.1}]}],
           "probes": [{"id": "ball", "system": "a", "index": 0}],
           "expect": [{"quantity": "ball.position.y", "equals": -4.905, "tolerance": 0.06, "source": "g t^2 / 2"}]}


class Check(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def save(self, name, scene):
        path = os.path.join(self.folder.name, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as f:
            json.dump(scene, f)

    def check(self, *arguments):
        return subprocess.run([BINARY, "check", self.folder.name, *arguments], capture_output=True, text=True, timeout=patience(60))

    def test_a_folder_of_scenes(self):
        self.save("plain.json", FALLING)
        self.save("below/varied.json", {**FALLING, "test": {"vary": {"precision": ["f32", "f64"]}}})
        self.save("below/based.json", {"scene": "../plain.json", "gravity": [0, -5, 0],
                                       "expect": [{"quantity": "ball.position.y", "equals": -2.5, "tolerance": 0.06}]})
        done = self.check()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("3 passed, 0 failed (4 runs"), done.stdout)
        self.assertIn("1 passed", self.check("-R", "based").stdout)
        self.assertEqual(self.check("-R", "nothing").returncode, 2)
        self.assertEqual(self.check("-R", "(").returncode, 2)
        self.assertEqual(len(self.check("--list").stdout.splitlines()), 3)

    def test_a_failure_is_a_line(self):
        self.save("moon.json", {**FALLING, "test": {"vary": {"/gravity/1": [-9.81, -1.6]}}})
        done = self.check()
        self.assertEqual(done.returncode, 6)
        line, end = done.stdout.splitlines()
        for part in ("moon.json: ", "/gravity/1 = -1.6: ", "ball.position.y = -0.8", "equal to -4.905 +- 0.06", "g t^2 / 2"):
            self.assertIn(part, line)
        self.assertTrue(end.startswith("0 passed, 1 failed"))
        scene = json.loads(self.check("--json").stdout)["scenes"][0]
        self.assertEqual((len(scene["runs"]), scene["passed"], len(scene["findings"])), (2, False, 1))
        self.assertAlmostEqual(scene["runs"][0]["measured"]["ball.position.y"], -4.905, delta=0.06)

    def test_a_control_that_does_not_fail_is_a_failure(self):
        self.save("control.json", {**FALLING, "test": {"control": [{"set": {"/gravity/0": 1}, "fails": ["ball.position.y"], "why": "it falls"}]}})
        done = self.check()
        self.assertEqual(done.returncode, 6)
        self.assertIn("control 0: control, wanted a failure: ball.position.y does not fail, it is -4.9", done.stdout)

    def test_what_is_no_scene_is_named(self):
        self.save("good.json", FALLING)
        self.save("typo.json", {**FALLING, "test": {"vry": {}}})
        done = self.check()
        self.assertEqual(done.returncode, 3)
        self.assertIn("/test/vry", done.stdout)
        self.assertIn("1 passed, 1 failed", done.stdout)

    def test_the_key_is_ignored_elsewhere(self):
        self.save("varied.json", {**FALLING, "test": {"vary": {"dt": [0.01, 0.02]}, "why": "a test"}})
        path = os.path.join(self.folder.name, "varied.json")
        for command in ("run", "validate"):
            done = subprocess.run([BINARY, command, path], capture_output=True, text=True, timeout=patience(60))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
