"""Sessions over HTTP: created once, stepped once, repeated exactly."""
import time
import unittest

from cases import OSCILLATOR, Case
from patience import patience


class Sessions(Case):
    def test_create_answers_with_location_and_links(self):
        answer = self.service.post("/v1/sessions", OSCILLATOR)
        self.assertEqual(answer.status, 201)
        session = answer.json()
        self.assertEqual(answer.headers["Location"], session["links"]["self"])
        for link in ("self", "step", "frames", "stream", "picture", "viewer"):
            self.assertIn(link, session["links"])
        self.assertEqual(self.service.get(session["links"]["self"]).json()["step"], 0)

    def test_damped_oscillator_through_http(self):
        # Closed form: exp(-t) (cos(sqrt(99) t) + sin(sqrt(99) t) / sqrt(99)) at t = 1 (reference case ode.damped).
        s = self.service.create({**OSCILLATOR, "time": {"dt": 0.001}})
        step = self.service.post(s["links"]["step"], {"seconds": 1}).json()
        self.assertEqual(step["step"], 1000)
        frame = self.service.get(s["links"]["latest_frame"]).json()
        x = frame["blocks"][0]["values"][0][0]
        self.assertAlmostEqual(x, -0.3368516805904133628, delta=1e-8)  # RK4: error (w dt)^4 / 120 * w = 8e-10
        self.assertEqual(frame["state_hash"], step["state_hash"])

    def test_from_step_is_a_precondition(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.post(s["links"]["step"], {"steps": 5, "from_step": 0}).json()["step"], 5)
        again = self.service.post(s["links"]["step"], {"steps": 5, "from_step": 0})
        self.assertEqual((again.status, again.json()["code"]), (409, "step_conflict"))
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], 5)

    def test_idempotency_key_repeats_the_answer_not_the_step(self):
        s = self.service.create(OSCILLATOR)
        key = {"Idempotency-Key": "one"}
        first = self.service.post(s["links"]["step"], {"steps": 3}, key)
        second = self.service.post(s["links"]["step"], {"steps": 3}, key)
        self.assertEqual(first.body, second.body)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], 3)
        other = self.service.post(s["links"]["step"], {"steps": 4}, key)
        self.assertEqual((other.status, other.json()["code"]), (422, "idempotency_key_reused"))

    def test_create_under_the_clients_own_id(self):
        path = "/v1/sessions/01234567-89ab-4cde-8f01-23456789abcd"
        self.assertEqual(self.service.request("PUT", path, OSCILLATOR).status, 201)
        self.assertEqual(self.service.request("PUT", path, OSCILLATOR).status, 200)
        changed = {**OSCILLATOR, "seed": 8}
        self.assertEqual(self.service.request("PUT", path, changed).status, 409)
        self.assertEqual(self.service.request("PUT", "/v1/sessions/x", OSCILLATOR).status, 400)

    def test_pages_of_sessions(self):
        made = {self.service.create(OSCILLATOR)["id"] for _ in range(5)}
        seen, token = set(), ""
        while True:
            page = self.service.get("/v1/sessions?limit=2&page_token=" + token).json()
            seen |= {s["id"] for s in page["sessions"]}
            token = page.get("next_page_token")
            if not token:
                break
        self.assertTrue(made <= seen)

    def test_deleted_sessions_are_unknown(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.request("DELETE", s["links"]["self"]).status, 204)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["code"], "unknown_session")

    def test_play_pause_reset(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.post(s["links"]["play"], {"speed": 4}).json()["status"], "playing")
        deadline = time.monotonic() + patience(20)
        while self.service.get(s["links"]["self"]).json()["step"] < 20 and time.monotonic() < deadline:
            time.sleep(0.02)
        paused = self.service.post(s["links"]["pause"]).json()
        self.assertGreaterEqual(paused["step"], 20)
        time.sleep(0.1)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], paused["step"])
        self.assertEqual(self.service.post(s["links"]["reset"]).json()["step"], 0)

    def test_snapshot_restore_and_branch_continue_the_trajectory(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 30})
        snapshot = self.service.post(s["links"]["snapshots"]).json()
        branch = self.service.post(s["links"]["self"] + "/branch").json()
        a = self.service.post(s["links"]["step"], {"steps": 40}).json()["state_hash"]
        b = self.service.post(branch["links"]["step"], {"steps": 40}).json()["state_hash"]
        self.service.post(s["links"]["snapshots"] + "/" + snapshot["id"] + "/restore")
        c = self.service.post(s["links"]["step"], {"steps": 40}).json()["state_hash"]
        self.assertEqual([a, a], [b, c])

    def test_the_scene_of_a_session_makes_the_same_session_again(self):
        s = self.service.create(OSCILLATOR)
        scene = self.service.get(s["links"]["scene"]).json()
        self.assertEqual(s["links"]["scene"], s["links"]["self"] + "/scene")
        # What the scene left out is there.
        self.assertIn("integrator", scene["systems"][0])
        self.assertEqual(scene["time"]["substeps"], 1)
        again = self.service.create(scene)
        self.assertEqual(again["state_hash"], s["state_hash"])
        hashes = [self.service.post(x["links"]["step"], {"steps": 50}).json()["state_hash"] for x in (s, again)]
        self.assertEqual(*hashes)
        self.assertEqual(self.service.get(again["links"]["scene"]).json(), scene)

    def test_a_branch_keeps_the_method_that_was_chosen(self):
        s = self.service.create({**OSCILLATOR, "accuracy": {"tolerance": 1e-5}})
        branch = self.service.post(s["links"]["self"] + "/branch").json()
        scenes = [self.service.get(x["links"]["scene"]).json() for x in (s, branch)]
        self.assertEqual(*scenes)
        self.assertEqual(branch["accuracy"], s["accuracy"])

    def test_seek_is_exact(self):
        s = self.service.create(OSCILLATOR)
        at_20 = self.service.post(s["links"]["step"], {"steps": 20}).json()["state_hash"]
        self.service.post(s["links"]["step"], {"steps": 80})
        back = self.service.post(s["links"]["self"] + "/seek", {"step": 20}).json()
        self.assertEqual((back["step"], back["state_hash"]), (20, at_20))

    def test_instability_says_where_and_what_would_have_held(self):
        s = self.service.create({"time": {"dt": 1}, "systems": [{"type": "oscillator", "id": "a", "stiffness": 1e6, "position": 1, "integrator": "symplectic_euler"}]})
        answer = self.service.post(s["links"]["step"], {"steps": 5000})
        self.assertEqual(answer.status, 409)
        problem = answer.json()
        self.assertEqual(problem["code"], "instability")
        self.assertEqual(problem["system"], "a")
        # omega = 1000 rad/s: symplectic Euler holds for dt < 2 / omega, and at 2 / omega it grows as the time does.
        self.assertLess(problem["suggested_dt"], 2e-3)
        self.assertGreater(problem["suggested_dt"], 1.7e-3)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], problem["last_good_step"])


if __name__ == "__main__":
    unittest.main()
