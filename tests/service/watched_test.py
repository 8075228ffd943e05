"""Sessions that somebody watches, watched, or never did: who plays on, what slow clients hear, and how a stream ends."""
import math
import time
import unittest

from cases import OSCILLATOR, Case
from harness import Socket
from patience import patience

GRACE = math.ceil(patience(0.25))  # s; on a slow machine a viewer takes longer to come back
ROPE = {"time": {"dt": 0.004}, "systems": [{"type": "mass_spring", "id": "rope", "stiffness": 2000, "mass": 0.01, "pinned": ["first"],
                                             "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 40}}]}
# More than a second of work for a second of the scene.
HEAVY = {"time": {"dt": 0.0001}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 100, "mass": 0.01, "integrator": "velocity_verlet",
                                              "cloth_grid": {"nx": 60, "ny": 60}}]}
# A ball that follows a path, and a point that falls.
MOVING = {"time": {"dt": 0.01}, "systems": [{"type": "particles", "id": "p", "positions": [[0, 1, 0]], "colliders": [
    {"type": "sphere", "id": "ball", "radius": 0.1, "center": [2, 0, 0], "motion": {"velocity": [1, 0, 0]}}]}]}


class Watched(Case):
    options = ("--pause-unwatched", "%ds" % GRACE)

    def stream(self, s, *kinds):
        ws = Socket(self.service, s["links"]["stream"], "truestep.v1.json")
        self.addCleanup(ws.close)
        ws.message("hello")
        return ws

    def status(self, s):
        return self.service.get(s["links"]["self"]).json()

    def eventually(self, what, seconds=5):
        end = time.monotonic() + patience(seconds)
        while time.monotonic() < end:
            if what():
                return
            time.sleep(0.05)
        self.fail("does not come about")

    def left(self, scene, body):
        s = self.service.create(scene)
        ws = self.stream(s)
        self.service.post(s["links"]["play"], body)
        ws.close()
        return s

    def test_a_session_whose_last_viewer_has_left_pauses(self):
        s = self.left(OSCILLATOR, {})
        self.assertEqual(self.status(s)["status"], "playing", "not before the grace is over")
        self.eventually(lambda: self.status(s)["status"] == "paused")
        self.assertEqual(self.status(s)["paused_because"], "unwatched")
        self.service.post(s["links"]["play"])
        self.assertNotIn("paused_because", self.status(s))

    def test_who_wants_it_plays_on(self):
        sessions = [self.left({**OSCILLATOR, "keep_running": True}, {}), self.left(OSCILLATOR, {"keep_running": True})]
        sessions.append(self.service.create(OSCILLATOR))  # never watched
        self.service.post(sessions[2]["links"]["play"])
        time.sleep(2.5 * GRACE)
        for s in sessions:
            self.assertEqual(self.status(s)["status"], "playing")

    def test_a_viewer_that_comes_back_in_time_changes_nothing(self):
        s = self.left(OSCILLATOR, {})
        time.sleep(0.3 * GRACE)
        self.stream(s)
        time.sleep(2 * GRACE)
        self.assertEqual(self.status(s)["status"], "playing")

    def test_overload_says_what_playing_comes_to(self):
        s = self.service.create(HEAVY)
        ws = self.stream(s)
        ws.send({"request_id": "p", "control": {"action": "play", "value": 10}})
        playback = ws.message("playback")
        end = time.monotonic() + patience(10)
        while not playback["achieved_speed"] and time.monotonic() < end:
            playback = ws.message("playback")
        self.assertGreater(playback["achieved_speed"], 0)
        self.assertLess(playback["achieved_speed"], 0.9 * playback["speed"])

        # It is what the steps say, on the mean: each reading is of half a second of a machine that has other work.
        def agrees():
            begun, first, readings = time.monotonic(), self.status(s)["time"], []
            while time.monotonic() < begun + 4:
                time.sleep(0.25)
                last = self.status(s)
                readings.append(last["achieved_speed"])
            measured = (last["time"] - first) / (time.monotonic() - begun)
            return abs(sum(readings) / len(readings) / measured - 1) < 0.3

        self.eventually(agrees, 10)
        self.service.request("DELETE", s["links"]["self"])
        idle = self.service.create(OSCILLATOR)
        self.service.post(idle["links"]["play"])
        self.eventually(lambda: abs(self.status(idle).get("achieved_speed", 0) - 1) < 0.05)

    def test_a_deleted_session_says_bye_at_once(self):
        s = self.service.create(OSCILLATOR)
        ws = self.stream(s)
        self.service.post(s["links"]["play"])
        begun = time.monotonic()
        self.service.request("DELETE", s["links"]["self"])
        bye = ws.message("bye")
        self.assertEqual((bye["code"], bye["reason"]), ("unknown_session", "the session has been deleted"))
        with self.assertRaisesRegex(ConnectionError, "4410"):
            ws.message("nothing")
        self.assertLess(time.monotonic() - begun, patience(1))

    def test_shapes_come_with_the_points_of_their_step(self):
        s = self.service.create(MOVING)
        ws = self.stream(s)
        ws.send({"request_id": "s", "subscribe": {"policy": "EVERY"}})
        ws.message("reply")
        self.service.post(s["links"]["step"], {"steps": 20})
        seen = 0
        while seen < 20:
            frame = ws.message("frame")
            step = int(frame["step"])
            if step == 0:
                continue
            seen = step
            self.assertAlmostEqual(frame["shapes"][0]["position"][0], 2 + 0.01 * step, delta=1e-9, msg="of another step")


class Series(Case):
    def series(self, s, query=""):
        return self.service.get(s["links"]["observables"] + query).json()["series"]

    def test_every_session_keeps_energy_from_the_start(self):
        s = self.service.create({k: v for k, v in OSCILLATOR.items() if k != "observables"})
        self.service.post(s["links"]["step"], {"steps": 500})
        series = self.series(s)
        self.assertEqual(series["step"][0], 0)
        self.assertGreater(len(series["step"]), 5)
        self.assertAlmostEqual(series["values"]["energy.total"][0], 50, delta=1e-12)  # k x^2 / 2
        self.assertNotIn("a.position", series["values"], "what nobody asked for is not kept")

    def test_probes_are_kept_and_the_scenes_list_adds_to_them(self):
        probe = {"id": "tip", "system": "rope", "index": -1, "fields": ["position"]}
        s = self.service.create({**ROPE, "probes": [probe]})
        self.service.post(s["links"]["step"], {"steps": 300})
        values = self.series(s)["values"]
        self.assertLess(values["tip.position.y"][-1], values["tip.position.y"][0])
        self.assertIn("energy.total", values)
        listed = self.service.create({**ROPE, "probes": [probe], "observables": ["rope.strain"]})
        self.service.post(listed["links"]["step"], {"steps": 300})
        series = self.series(listed)
        self.assertEqual(series["step"], list(range(301)), "what a scene lists is worth every step")
        for name in ("energy.total", "tip.position.y", "rope.strain.max"):
            self.assertIn(name, series["values"])

    def test_it_is_bounded(self):
        s = self.service.create({k: v for k, v in OSCILLATOR.items() if k != "observables"})
        self.service.post(s["links"]["step"], {"steps": 200000})
        steps = self.series(s, "?max_points=1000000")["step"]
        self.assertLessEqual(len(steps), 2048)
        self.assertGreater(len(steps), 200)
        self.assertGreater(steps[-1], 100000)


if __name__ == "__main__":
    unittest.main()
