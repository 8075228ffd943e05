"""States and whole sessions that go from one process to another: snapshots as files, bundles that are replayed."""
import json
import pathlib
import random
import subprocess
import tempfile
import unittest

from cases import OSCILLATOR, Case
from harness import BINARY, Service

SCENES = ("hanging_cloth", "fountain", "newtons_cradle_2d", "ragdoll_stairs", "bouncing_ball_events", "rain_on_cloth")
PUSHED = {"time": {"dt": 0.01, "duration": 3}, "systems": [
    {"type": "mass_spring", "id": "rope", "pinned": ["first"], "rope": {"from": [0, 1, 0], "to": [0.8, 1, 0], "links": 20}}]}


def program(*arguments):
    return subprocess.run([BINARY, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


class Portable(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.other = Service("--threads", "1")
        cls.addClassCleanup(cls.other.stop)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def upload(self, service, session, data):
        return service.request("POST", session["links"]["snapshots"], data, {"Content-Type": "application/octet-stream"})

    def snapshot(self, session):
        taken = self.service.post(session["links"]["snapshots"])
        return self.service.get(taken.headers["Location"]).body

    def step(self, service, session, steps):
        return service.post(session["links"]["step"], {"steps": steps}).json()["state_hash"]

    def test_a_snapshot_continues_on_another_server_and_without_one(self):
        for name in SCENES:
            here, there = self.service.create({"gallery": name}), self.other.create({"gallery": name})
            self.step(self.service, here, 25)
            data = self.snapshot(here)
            sent = self.upload(self.other, there, data)
            self.assertEqual(sent.status, 201, sent.body)
            at = self.other.post(sent.headers["Location"] + "/restore").json()
            self.assertEqual((at["step"], at["state_hash"]), (25, sent.json()["state_hash"]))
            wanted = self.step(self.service, here, 30)
            self.assertEqual(self.step(self.other, there, 30), wanted, name)
            file = self.folder / "snapshot"
            file.write_bytes(data)
            run = program("run", name, "--from", file, "--steps", 30, "--json", "--progress", "none")
            self.assertEqual(json.loads(run.stdout)["state_hash"], wanted, (name, run.stderr))
            self.assertEqual(json.loads(run.stdout)["steps"], 55)

    def test_a_run_saves_what_another_continues(self):
        file = self.folder / "snapshot"
        program("run", "hanging_cloth", "--steps", 40, "--snapshot", file, "--progress", "none")
        parts = program("run", "hanging_cloth", "--steps", 20, "--from", file, "--json", "--progress", "none")
        whole = program("run", "hanging_cloth", "--steps", 60, "--json", "--progress", "none")
        self.assertEqual(*[json.loads(r.stdout)["state_hash"] for r in (parts, whole)])

    def test_snapshots_of_other_scenes_and_damaged_ones_are_refused(self):
        here = self.service.create(PUSHED)
        self.step(self.service, here, 10)
        data = self.snapshot(here)
        self.assertEqual(self.upload(self.service, here, data).status, 201, "the control")
        # The same columns, another spring: continuing from it would be neither run.
        stiffer = self.service.create({**PUSHED, "systems": [{**PUSHED["systems"][0], "stiffness": 2000}]})
        cloth = self.service.create({"gallery": "hanging_cloth"})
        chance = random.Random(7)
        bad = [data[:n] for n in (1, 8, 24, len(data) // 2, len(data) - 1)] + [data + b"\0"]
        for _ in range(300):
            at = chance.randrange(len(data))
            bad.append(data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1:])
        for session, bytes_ in [(stiffer, data), (cloth, data)] + [(here, b) for b in bad]:
            answer = self.upload(self.service, session, bytes_)
            self.assertEqual((answer.status, answer.json()["code"]), (422, "bad_snapshot"))
        file = self.folder / "snapshot"
        file.write_bytes(bad[3])
        self.assertEqual(program("run", "hanging_cloth", "--from", file).returncode, 3)
        self.assertEqual(program("run", "hanging_cloth", "--from", self.folder / "none").returncode, 2)
        # A title changes nothing that moves.
        titled = self.service.create({**PUSHED, "title": "the same", "time": {"dt": 0.01, "duration": 9}})
        self.assertEqual(self.upload(self.service, titled, data).status, 201)

    def bundle(self):
        """Of a session that was commanded, went back, was commanded otherwise and went on."""
        s = self.service.create(PUSHED)

        def command(**c):
            self.assertEqual(self.service.post(s["links"]["commands"], {"system": "rope", **c}).status, 202)
        command(type="impulse", index=20, impulse=[0, 0.1, 0.3])
        self.step(self.service, s, 60)
        command(type="drag", index=10, target=[0.1, 1.4, 0.2])
        self.step(self.service, s, 60)
        self.service.post(s["links"]["self"] + "/seek", {"step": 90})
        command(type="release", index=-1)
        command(type="set_parameter", name="gravity", vector=[0, -3, 0])
        self.step(self.service, s, 75)
        return self.service.get(s["links"]["bundle"]).body, self.service.get(s["links"]["self"]).json()

    def test_a_bundle_is_replayed_to_the_same_hash(self):
        data, session = self.bundle()
        file = self.folder / "bundle"
        file.write_bytes(data)
        for threads in (1, 2):
            done = program("replay", file, "--json", "--threads", threads, "--progress", "none")
            said = json.loads(done.stdout)
            self.assertEqual((done.returncode, said["equal"], said["step"], said["commands"]), (0, True, 165, 4), done.stderr)
            self.assertEqual(said["state_hash"], session["state_hash"])

    def test_a_bundle_begins_where_the_journal_does(self):
        s = self.service.create(PUSHED)
        self.step(self.service, s, 20)
        taken = self.service.post(s["links"]["snapshots"])
        self.step(self.service, s, 20)
        self.service.post(taken.headers["Location"] + "/restore")
        wanted = self.step(self.service, s, 10)
        file = self.folder / "bundle"
        file.write_bytes(self.service.get(s["links"]["bundle"]).body)
        said = json.loads(program("replay", file, "--json", "--progress", "none").stdout)
        self.assertEqual((said["equal"], said["first_step"], said["step"], said["state_hash"]), (True, 20, 30, wanted))

    def test_damaged_bundles_are_refused(self):
        data, _ = self.bundle()
        file = self.folder / "bundle"
        snapshot = self.snapshot(self.service.create(OSCILLATOR))
        flipped = data[:200] + bytes([data[200] ^ 4]) + data[201:]
        for bad in (b"", data[:10], data[:-1], data + b"\0", flipped, snapshot, b"{}"):
            file.write_bytes(bad)
            done = program("replay", file)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn("the bundle cannot be used", done.stderr)


if __name__ == "__main__":
    unittest.main()
