"""What scenes are estimated to take, as `validate` says: ratios between estimates follow what is really done, on any machine."""
import json
import subprocess
import unittest

from harness import BINARY
from patience import patience


def estimate(systems, couplings=(), dt=1 / 60, **time):
    scene = {"time": {"dt": dt, "duration": 1, **time}, "systems": systems, "couplings": list(couplings)}
    done = subprocess.run([BINARY, "validate", "-", "--json"], input=json.dumps(scene), capture_output=True, text=True, timeout=patience(60))
    said = json.loads(done.stdout)
    assert said["valid"], said["errors"]
    return said["estimate"]


def cloth(kind, n):
    return {"type": kind, "id": "a", "cloth_grid": {"origin": [-0.5, 0, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": n, "ny": n},
            "mass": 0.01, "thickness": 0.01, "stiffness": 1000, "pinned": ["corners"]}


BALL = {"type": "rigid3d", "id": "b", "bodies": [{"type": "sphere", "position": [0, 0.5, 0], "radius": 0.1}]}
CONTACT = {"type": "contact", "id": "c", "a": "a", "b": "b"}


def rope(name, links, x):
    return {"type": "mass_spring", "id": name, "rope": {"from": [x, 1, 0], "to": [x + 1, 1, 0], "links": links}, "mass": 0.01, "stiffness": 1000}


class Estimates(unittest.TestCase):
    def test_shorter_steps_of_constraints_have_fewer_substeps_of_their_own(self):
        whole, divided = (estimate([cloth("xpbd", 30)], substeps=n)["seconds_per_step"] for n in (1, 10))
        self.assertLess(divided, 3 * whole)
        self.assertGreater(divided, whole / 3)

    def test_points_that_meet_bodies_are_not_factorised(self):
        small, large = (estimate([cloth("mass_spring", n), BALL], [CONTACT], substeps=40)["seconds_per_step"] for n in (20, 60))
        # Nine times as many points; a factor would take nine to the power of 1.75, 47 times as long.
        self.assertLess(large, 14 * small)
        self.assertGreater(large, 4 * small)

    def test_larger_bodies_touch_more_of_a_cloth(self):
        def of(radius):
            ball = {**BALL, "bodies": [{**BALL["bodies"][0], "radius": radius}]}
            return estimate([cloth("mass_spring", 40), ball], [CONTACT], substeps=40)["seconds_per_step"]
        self.assertGreater(of(0.2), 1.5 * of(0.05))

    def test_a_stiff_attachment_asks_both_sides_and_a_soft_one_neither(self):
        def of(stiffness, links=60):
            tie = {"type": "attachment", "id": "c", "a": "a", "b": "b", "a_points": [-1], "b_points": [0], "stiffness": stiffness}
            return estimate([rope("a", links, 0), rope("b", links, 1.1)], [tie])["seconds_per_step"]
        self.assertGreater(of(1e6), 1.5 * of(0.01))
        self.assertGreater(of(1e6, 120), 1.4 * of(1e6))


if __name__ == "__main__":
    unittest.main()
