"""What tests of restarts share: a folder, one server after another on it, and a scene that commands change."""
import pathlib
import re
import shutil
import tempfile
import time
import unittest

from harness import Service
from patience import patience

ROPE = {"name": "a rope", "time": {"dt": 0.004, "duration": 1000}, "observables": ["energy"],
        "systems": [{"type": "mass_spring", "id": "rope", "stiffness": 2000, "mass": 0.01, "pinned": ["first"],
                     "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 40}}]}
STATE = re.compile(r"state\.(\d+)\.(\d+)")
PUSH = {"type": "impulse", "system": "rope", "index": 20, "impulse": [0, 0, 0.01]}


class Restarted(unittest.TestCase):
    """A folder, and one server after another on it."""
    options = ()

    def setUp(self):
        self.data = tempfile.mkdtemp(prefix="truestep")
        self.addCleanup(shutil.rmtree, self.data, ignore_errors=True)
        self.service = None
        self.start()
        self.addCleanup(self.kill)

    def start(self, *options):
        self.service = Service(*self.options, *options, data=self.data)
        end = time.monotonic() + patience(20)
        while self.service.get("/readyz").status != 200 and time.monotonic() < end:
            time.sleep(0.02)

    def kill(self):
        self.service.process.kill()
        self.service.process.wait(patience(10))
        self.service.process.stdout.close()

    def again(self, *options, how="kill"):
        if how == "kill":
            self.kill()
        else:
            self.service.process.terminate()
            self.assertEqual(self.service.process.wait(patience(10)), 0)
            self.service.process.stdout.close()
        self.start(*options)

    def step(self, session, n):
        answer = self.service.post(session["links"]["step"], {"steps": n})
        self.assertEqual(answer.status, 200, answer.body)
        return answer.json()

    def look(self, session):
        answer = self.service.get(session["links"]["self"])
        self.assertEqual(answer.status, 200, answer.body)
        return answer.json()

    def uninterrupted(self, scene, course):
        """The hash that a session has after a course of ("step", n) and ("command", c)."""
        s = self.service.create(scene)
        self.follow(s, course)
        now = self.look(s)
        self.service.request("DELETE", s["links"]["self"])
        return now["step"], now["state_hash"]

    def follow(self, s, course):
        for what, value in course:
            if what == "step":
                self.step(s, value)
            else:
                self.assertEqual(self.service.post(s["links"]["commands"], value).status, 202)

    def folder(self, session):
        return pathlib.Path(self.data) / "sessions" / session["id"]

    def newest_state(self, session):
        """The step of the newest state that is saved on disk, 0 for the start."""
        # A state that is being written has one more suffix until it is renamed: it is none yet.
        states = (STATE.fullmatch(path.name) for path in self.folder(session).glob("state.*.*"))
        return max(((int(name[1]), int(name[2])) for name in states if name), default=(0, 0))[1]
