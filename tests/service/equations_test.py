"""Systems of equations through the running service: stepping, commands, pictures, recordings, faults."""
import unittest

from cases import Case

VAN_DER_POL = {"name": "van der Pol", "time": {"dt": 0.05, "duration": 1},
               "systems": [{"type": "ode", "id": "v", "states": {"x": 1, "y": 0}, "parameters": {"mu": 5},
                            "equations": {"x": "y", "y": "mu*(1-x^2)*y-x"}, "tolerance": 1e-9}],
               "observables": ["v.x"]}


class Equations(Case):
    def test_a_scene_of_text_steps_streams_and_draws(self):
        s = self.service.create(VAN_DER_POL)
        step = self.service.post(s["links"]["step"], {"seconds": 1}).json()
        self.assertEqual(step["step"], 20)
        frame = self.service.get(s["links"]["latest_frame"]).json()
        self.assertEqual(frame["state_hash"], step["state_hash"])
        self.assertEqual(frame["blocks"][0]["field"], "position")
        picture = self.service.get(s["links"]["picture"])
        self.assertEqual((picture.status, picture.body[:4]), (200, b"\x89PNG"))
        series = self.service.get(s["links"]["self"] + "/observables").json()
        self.assertIn("v.x", str(series))

    def test_commands_set_parameters_and_the_journal_repeats_them(self):
        s = self.service.create(VAN_DER_POL)
        own = s["links"]["self"]
        self.service.post(s["links"]["step"], {"steps": 5})
        done = self.service.post(own + "/commands", {"type": "set_parameter", "system": "v", "name": "mu", "value": 1})
        self.assertLess(done.status, 300)
        end = self.service.post(s["links"]["step"], {"steps": 15}).json()["state_hash"]
        self.service.post(own + "/seek", {"step": 2})
        self.assertEqual(self.service.post(own + "/seek", {"step": 20}).json()["state_hash"], end)
        bad = self.service.post(own + "/commands", {"type": "set_parameter", "system": "v", "name": "nu", "value": 1})
        self.assertEqual(bad.status, 422)
        self.assertEqual(bad.json()["errors"][0]["did_you_mean"], "mu")

    def test_faults_name_the_text_and_the_place(self):
        scene = {"systems": [{"type": "ode", "states": {"x": 1, "y": 0}, "equations": {"x": "yy + 1", "y": "sin(x"}}]}
        answer = self.service.post("/v1/sessions", scene)
        self.assertEqual(answer.status, 422)
        errors = {e["pointer"]: e for e in answer.json()["errors"]}
        self.assertEqual(set(errors), {"/systems/0/equations/x", "/systems/0/equations/y"})
        self.assertEqual(errors["/systems/0/equations/x"]["did_you_mean"], "y")
        self.assertIn("column 6", errors["/systems/0/equations/y"]["message"])

    def test_texts_that_expand_without_bound_are_refused_fast(self):
        bomb = "sum(a, 0, 9999, sum(b, 0, 9999, sum(c, 0, 9999, a * b * c * x)))"
        scene = {"systems": [{"type": "ode", "states": {"x": 1}, "equations": {"x": bomb}}]}
        answer = self.service.made(scene)
        self.assertIn(answer.status, (413, 422))

    def test_a_run_that_explodes_names_the_state(self):
        scene = {"time": {"dt": 0.1}, "systems": [{"type": "ode", "id": "b", "states": {"wild": 1}, "equations": {"wild": "wild^2"}}]}
        s = self.service.create(scene)
        problem = self.service.post(s["links"]["step"], {"steps": 20}).json()
        self.assertEqual((problem["code"], problem["system"]), ("instability", "b"))


if __name__ == "__main__":
    unittest.main()
