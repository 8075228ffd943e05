"""Substeps of points that bodies press on or hang on: what `validate` says of too few, and the remedy it names."""
import json
import subprocess
import unittest

from harness import BINARY
from patience import patience


def scene(**time):
    return {"gravity": [0, -9.81, 0], "time": {"dt": 1 / 60, "duration": 1, **time},
            "systems": [{"type": "xpbd", "id": "cloth", "mass": 0.01, "stiffness": 10000, "thickness": 0.02, "pinned": ["corners"],
                         "cloth_grid": {"origin": [-0.5, 0, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 5, "ny": 5}},
                        {"type": "rigid3d", "id": "ball", "bodies": [{"type": "sphere", "position": [0, 0.2, 0], "mass": 5, "radius": 0.1}]}],
            "couplings": [{"type": "contact", "id": "touch", "a": "cloth", "b": "ball"}]}


def validate(document):
    done = subprocess.run([BINARY, "validate", "-", "--json"], input=json.dumps(document), capture_output=True, text=True,
                          timeout=patience(60))
    return json.loads(done.stdout)


class PressedSubsteps(unittest.TestCase):
    def test_too_few_are_warned_of_with_a_number_that_holds(self):
        said = validate(scene(substeps=2))
        warning, = [w for w in said["warnings"] if w["code"] == "few_substeps"]
        self.assertEqual(warning["pointer"], "/time/substeps")
        enough = int(warning["allowed"].split()[2].rstrip(","))
        self.assertEqual([w for w in validate(scene(substeps=enough))["warnings"] if w["code"] == "few_substeps"], [])
        self.assertNotEqual([w for w in validate(scene(substeps=enough - 1))["warnings"] if w["code"] == "few_substeps"], [])

    def planned(self, document):
        row, = [p for p in validate(document)["plan"] if p["pass"] == "substeps" and not p.get("system")]
        return int(row["reason"].split()[0])

    def test_the_default_is_enough_and_the_plan_says_it(self):
        self.assertEqual([w for w in validate(scene())["warnings"] if w["code"] == "few_substeps"], [])
        self.assertGreater(self.planned(scene()), 10)

    def test_a_light_ball_asks_for_fewer(self):
        light = scene()
        light["systems"][1]["bodies"][0]["mass"] = 0.001
        self.assertLess(self.planned(light), self.planned(scene()))


if __name__ == "__main__":
    unittest.main()
