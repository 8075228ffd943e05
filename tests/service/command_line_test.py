"""The program without a server: exit codes and what it prints."""
import json
import subprocess
import unittest

from cases import OSCILLATOR
from harness import BINARY
from patience import patience


class CommandLine(unittest.TestCase):
    def run_truestep(self, *arguments, text=None):
        return subprocess.run([BINARY, *arguments], input=text, capture_output=True, text=True, timeout=patience(60))

    def test_exit_codes(self):
        good = json.dumps(OSCILLATOR)
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5", text=good).returncode, 0)
        self.assertEqual(self.run_truestep("run").returncode, 2)
        self.assertEqual(self.run_truestep("run", "-", text="{}").returncode, 3)
        unstable = {"time": {"dt": 1}, "systems": [{"type": "oscillator", "stiffness": 1e6, "position": 1, "integrator": "euler"}]}
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5000", text=json.dumps(unstable)).returncode, 4)
        missed = {**OSCILLATOR, "expect": [{"quantity": "energy.total", "min": 1e9, "source": "a control"}]}
        self.assertEqual(self.run_truestep("run", "-", text=json.dumps(missed)).returncode, 6)

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
