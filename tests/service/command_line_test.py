"""The program without a server: exit codes and what it prints."""
import json
import subprocess
import unittest

from cases import OSCILLATOR
from harness import BINARY


class CommandLine(unittest.TestCase):
    def run_truestep(self, *arguments, text=None):
        return subprocess.run([BINARY, *arguments], input=text, capture_output=True, text=True, timeout=120)

    def test_exit_codes(self):
        good = json.dumps(OSCILLATOR)
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5", text=good).returncode, 0)
        self.assertEqual(self.run_truestep("run").returncode, 2)
        self.assertEqual(self.run_truestep("run", "-", text="{}").returncode, 3)
        unstable = {"time": {"dt": 1}, "systems": [{"type": "oscillator", "stiffness": 1e6, "position": 1, "integrator": "euler"}]}
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5000", text=json.dumps(unstable)).returncode, 4)
        missed = {**OSCILLATOR, "expect": [{"quantity": "energy.total", "min": 1e9, "source": "a control"}]}
        self.assertEqual(self.run_truestep("run", "-", text=json.dumps(missed)).returncode, 6)

    def unstable(self, system, *arguments, dt=1 / 60, more={}):
        scene = {"time": {"dt": dt}, "systems": [system], **more}
        done = self.run_truestep("run", "-", "--json", *arguments, text=json.dumps(scene))
        self.assertEqual(done.returncode, 4, done.stdout[-400:])
        return json.loads(done.stdout)["instability"]

    def test_energy_from_nothing_ends_with_exit_code_4(self):
        event = self.unstable({"type": "mass_spring", "id": "rope", "stiffness": 1e12, "integrator": "linear_implicit_euler",
                               "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 20}, "pinned": ["first"]}, "--seconds", "2")
        self.assertEqual(event["system"], "rope")
        self.assertIn(event["quantity"], ("energy", "velocity"))
        self.assertAlmostEqual(event["time"], event["step"] / 60)
        for part in ('system "rope"', "step %d" % event["step"], "t = ", " s)"):
            self.assertIn(part, event["detail"])

    def test_remedies_are_those_that_held(self):
        event = self.unstable({"type": "rod_chain", "id": "chain", "substeps": 1}, "--seconds", "5")
        self.assertIn("held when tried for", event["remedies"][0])
        self.assertIn("substeps", event["remedies"][0])
        parts = int(event["remedies"][0].split(", or ")[1].split()[0])
        again = {"time": {"dt": 1 / 60, "substeps": parts}, "systems": [{"type": "rod_chain", "id": "chain", "substeps": 1}]}
        self.assertEqual(self.run_truestep("run", "-", "--steps", str(event["step"]), text=json.dumps(again)).returncode, 0)
        self.assertLess(event["suggested_dt"], 1 / 60)

    def test_numbers_beyond_all_bounds_end_with_exit_code_4(self):
        ball = {"type": "particles", "id": "p", "positions": [[0, 1, 0]], "velocities": [[0, 0, 0]]}
        attracted = {**ball, "attractors": [{"position": [0, 0, 0], "mu": 1e300}]}
        huge = {"type": "rigid3d", "id": "b", "bodies": [{"sphere": {"radius": 1e150}}]}
        for system in (attracted, huge):
            self.unstable(system, "--steps", "3")

    def test_run_prints_one_json_object(self):
        done = self.run_truestep("run", "-", "--steps", "100", "--json", "--progress", "none", text=json.dumps(OSCILLATOR))
        result = json.loads(done.stdout)
        for key in ("steps", "time", "wall_seconds", "state_hash", "observables", "expect"):
            self.assertIn(key, result)
        again = json.loads(self.run_truestep("run", "-", "--steps", "100", "--json", "--threads", "3", text=json.dumps(OSCILLATOR)).stdout)
        self.assertEqual(result["state_hash"], again["state_hash"])

    def test_validate_lists_faults(self):
        done = self.run_truestep("validate", "-", text='{"systems": [{"type": "oscillator", "mas": 1}]}')
        self.assertEqual(done.returncode, 3)
        self.assertIn("/systems/0/mas", done.stdout)
        self.assertIn('did you mean "mass"', done.stdout)


if __name__ == "__main__":
    unittest.main()
