"""The program without a server: exit codes and what it prints."""
import csv
import json
import os
import subprocess
import tempfile
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
        # 11 steps of 0.03 s are a rounding error less than 0.33 s, and a whole run all the same.
        missed["time"] = {"dt": 0.03, "duration": 0.33}
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
        self.unstable(attracted, "--steps", "3")
        # Its mass is no number: it does not even start.
        huge = {"systems": [{"type": "rigid3d", "id": "b", "bodies": [{"type": "sphere", "radius": 1e150}]}]}
        done = self.run_truestep("run", "-", "--steps", "3", text=json.dumps(huge))
        self.assertEqual((done.returncode, "/systems/0" in done.stderr), (3, True), done.stderr)

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

    def test_time_series(self):
        scene = json.dumps({**OSCILLATOR, "probes": [{"id": "tip", "system": OSCILLATOR["systems"][0].get("id", "oscillator0"), "fields": ["position"]}]})
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "out.csv")
            done = self.run_truestep("run", "-", "--steps", "10", "--every", "2", "--observe", "energy,tip", "--csv", path, "--json", text=scene)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(set(json.loads(done.stdout)["observables"]),
                             {"energy.kinetic", "energy.potential", "energy.total", "tip.position.x", "tip.position.y", "tip.position.z"})
            with open(path, newline="") as file:
                rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["step", "time [s]", "energy.kinetic [J]", "energy.potential [J]", "energy.total [J]",
                                   "tip.position.x [m]", "tip.position.y [m]", "tip.position.z [m]"])
        self.assertEqual([int(r[0]) for r in rows[1:]], [0, 2, 4, 6, 8, 10])
        self.assertTrue(all(len(r) == len(rows[0]) for r in rows))
        # On standard output there is nothing else.
        piped = self.run_truestep("run", "-", "--steps", "4", "--observe", "energy.total", "--csv", "-", text=scene)
        self.assertEqual([line.count(",") for line in piped.stdout.splitlines()], [2] * 6)
        self.assertIn("hash", piped.stderr)
        self.assertEqual(self.run_truestep("run", "-", "--csv", "-", "--json", text=scene).returncode, 2)

    def test_unknown_observable_is_refused_with_the_nearest(self):
        done = self.run_truestep("run", "-", "--observe", "enrgy", "--csv", "-", text=json.dumps(OSCILLATOR))
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn('did you mean "energy"', done.stderr)

    def test_a_recording_holds_all_observables_unless_the_scene_names_some(self):
        with tempfile.TemporaryDirectory() as folder:
            for named, expected in ((None, {"energy.kinetic", "energy.potential", "energy.total"}), (["energy.total"], {"energy.total"})):
                path = os.path.join(folder, "run.vtkhdf")
                scene = {k: v for k, v in OSCILLATOR.items() if k != "observables"} | ({"observables": named} if named else {})
                self.assertEqual(self.run_truestep("run", "-", "--steps", "4", "-o", path, text=json.dumps(scene)).returncode, 0)
                info = json.loads(self.run_truestep("info", path, "--json").stdout)
                held = {o["name"] if isinstance(o, dict) else o for o in info["observables"]}
                self.assertLessEqual(expected, held)
                self.assertEqual(named is None, len(held) > 1)
                os.remove(path)

    def test_states_without_a_place_are_recorded(self):
        decay = {"systems": [{"type": "ode", "id": "c", "states": {"y": 1}, "equations": {"y": "-y"}}]}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "run.vtkhdf")
            done = self.run_truestep("run", "-", "--steps", "3", "-o", path, text=json.dumps(decay))
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_descriptions_name_rows_fields_and_observables(self):
        text = self.run_truestep("systems", "mass_spring").stdout
        for words in ("a row is a point", "strain (1)", "reaction.x .y .z (N)", "pins (1)"):
            self.assertIn(words, text)
        described = json.loads(self.run_truestep("systems", "rigid3d", "--json").stdout)
        self.assertIn("a body", described["rows"])
        self.assertIn("orientation", [f["name"] for f in described["fields"]])
        self.assertIn("joint.<id>.angle", [o["name"] for o in described["observables"]])

    def test_faults_show_values_where_there_are_any(self):
        done = self.run_truestep("validate", "-", text='{"systems": [{"type": "oscillator", "zz": 1}, {"type": "mass_spring", "rope": {"from": [0, 0, 0]}}]}')
        self.assertNotIn("did you mean", done.stdout.splitlines()[0])
        self.assertNotIn("(got null)", done.stdout)


if __name__ == "__main__":
    unittest.main()
