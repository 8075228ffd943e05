"""Requests that take long to read: others are answered meanwhile, their findings are bounded, and what they take is bounded by
the memory of the server. Measured by measure_heavy.py."""
import json
import os
import pathlib
import shutil
import tempfile
import threading
import time
import unittest

from cases import OSCILLATOR, Case
from harness import Service
from measure_heavy import scene_of_assets, scene_of_unknown_keys, send
from patience import patience


class Heavy(Case):
    def while_busy(self, path, body, clients=4):
        """What each of these took to be answered while four clients wait for `body`: (requests answered before the first of
        the four was, in order)."""
        session = self.service.create(OSCILLATOR)["id"]
        ended = []

        def client():
            status = send(self.service, path, body)
            ended.append((time.monotonic(), status))

        threads = [threading.Thread(target=client) for _ in range(clients)]
        for t in threads:
            t.start()
        answered = []
        until = time.monotonic() + patience(120)
        while len(ended) < clients and time.monotonic() < until:
            for ask in (lambda: self.service.get("/v1/sessions/" + session), lambda: self.service.get("/healthz"),
                        lambda: self.service.post("/v1/sessions/%s/step" % session, {"steps": 1})):
                self.assertEqual(ask().status, 200)
                answered.append(time.monotonic())
        for t in threads:
            t.join()
        return answered, sorted(ended)

    def test_others_are_answered_while_scenes_are_read(self):
        """Of 4 requests, each of which is work for seconds, two at a time at most are read, and neither they nor those that
        wait hold up what is small: dozens of small requests are answered before the last of the four."""
        for path in ("/v1/sessions", "/v1/runs"):
            for scene in (scene_of_assets(self.service, 100_000), scene_of_unknown_keys()):
                body = '{"scene": %s}' % scene if path == "/v1/runs" else scene
                answered, ended = self.while_busy(path, body)
                self.assertEqual(len(ended), 4)
                before_last = [t for t in answered if t < ended[-1][0]]
                self.assertGreater(len(before_last), 30, (path, ended[-1][0] - answered[0]))

    def test_findings_are_bounded(self):
        for count in (150, 200_000):
            answer = self.service.request("POST", "/v1/sessions", scene_of_unknown_keys(count), {"Content-Type": "application/json"})
            self.assertEqual(answer.status, 422)
            errors = answer.json()["errors"]
            self.assertEqual(len(errors), 101)
            self.assertEqual(errors[-1]["code"], "more_faults")
            self.assertTrue(all(e["code"] == "unknown_key" for e in errors[:-1]))
        # A control: those that fit are all listed.
        errors = self.service.post("/v1/sessions", json.loads(scene_of_unknown_keys(20))).json()["errors"]
        self.assertEqual([e["code"] for e in errors], ["unknown_key"] * 20)

    def test_small_requests_take_no_large_bodies(self):
        """What is read on the thread that answers others has a bound."""
        session = self.service.create(OSCILLATOR)["id"]
        long_body = json.dumps({"steps": 1, **{"x%d" % k: k for k in range(20_000)}})
        for path in ("step", "play", "seek", "branch"):
            answer = self.service.request("POST", "/v1/sessions/%s/%s" % (session, path), long_body, {"Content-Type": "application/json"})
            self.assertEqual((answer.status, answer.json()["code"]), (413, "too_large"), path)


def cpu_by_niceness(service):
    """CPU time (s) of the threads that answer requests, and of those that yield to them."""
    seconds = [0.0, 0.0]
    for task in pathlib.Path("/proc/%d/task" % service.process.pid).iterdir():
        fields = (task / "stat").read_text().rsplit(")", 1)[1].split()
        seconds[int(fields[16]) > 0] += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return seconds


class Restored(unittest.TestCase):
    """Sessions of long scenes come back from disk."""

    def test_long_scenes_are_read_on_threads_that_answer_nobody(self):
        data = tempfile.mkdtemp(prefix="truestep")
        self.addCleanup(shutil.rmtree, data, ignore_errors=True)
        service = Service(data=data)
        scene = {"time": {"dt": 0.01}, "systems": [{"type": "particles", "id": "p", "positions": [[k % 97, k % 89, k / 1e3] for k in range(150_000)]}]}
        sessions = [service.create(scene)["id"] for _ in range(4)]
        service.process.terminate()
        service.process.wait(patience(60))
        service.process.stdout.close()
        service = Service(data=data)
        self.addCleanup(service.stop)
        before = cpu_by_niceness(service)
        for session in sessions:
            while service.get("/v1/sessions/" + session).json().get("status") in ("creating", "restoring"):
                time.sleep(0.01)
        answering, yielding = (now - then for now, then in zip(cpu_by_niceness(service), before))
        self.assertGreater(yielding, 0.1, "this is work")
        self.assertLess(answering, 0.25 * yielding)


class LittleMemory(Case):
    options = ("--max-memory", "200")

    def test_assets_named_often_are_refused_by_the_budget(self):
        scene = scene_of_assets(self.service, 400_000, 20)
        answer = self.service.request("POST", "/v1/scenes/validate", scene, {"Content-Type": "application/json"})
        self.assertEqual((answer.status, answer.json()["code"]), (429, "quota_exceeded"))
        # Nothing stays leased.
        self.assertEqual(self.service.request("POST", "/v1/scenes/validate", scene_of_assets(self.service, 1000, 2),
                                              {"Content-Type": "application/json"}).status, 200)


if __name__ == "__main__":
    unittest.main()
