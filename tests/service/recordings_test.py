"""Recordings outlive their sessions and servers: listed, downloaded, continued, bounded, and whole as far as the disk had room."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest
import uuid

from harness import BINARY, Socket
from patience import patience
from restarted import PUSH, ROPE, Restarted

PYTHON = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "venv" / "bin" / "python")


def info(path):
    done = subprocess.run([BINARY, "info", "--json", str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


class Recordings(Restarted):
    SCENE = {**ROPE, "recording": {}}

    def recordings(self):
        return self.service.get("/v1/recordings").json()["recordings"]

    def download(self, recording):
        answer = self.service.get(recording["links"]["file"])
        self.assertEqual(answer.status, 200, answer.body[:200])
        path = pathlib.Path(self.data) / "download.h5"
        path.write_bytes(answer.body)
        self.addCleanup(lambda: path.unlink(missing_ok=True))
        return path

    def test_a_session_that_runs_is_recorded_from_then_on_and_after_a_restart(self):
        s = self.service.create({k: v for k, v in self.SCENE.items() if k != "recording"})
        self.step(s, 30)
        link = s["links"]["self"] + "/recording"
        self.assertEqual(self.service.get(link).status, 404, "the control: nothing is recorded yet")
        wrong = self.service.post(link, {"every": 0, "fields": ["colour"], "evry": 1})
        self.assertEqual(wrong.status, 400, wrong.body)
        wrong = self.service.post(link, {"fields": ["colour"]})
        self.assertEqual((wrong.status, wrong.json()["errors"][0]["pointer"]), (422, "/fields/0"))
        begun = self.service.post(link, {"every": 5, "fields": ["velocity"], "precision": "f64"})
        self.assertEqual((begun.status, begun.json()["state"]), (201, "live"), begun.body)
        self.assertEqual(self.service.post(link, {}).status, 409, "one at a time")
        self.step(s, 20)
        self.again(how="term")
        self.step(s, 20)
        ended = self.service.request("DELETE", link)
        self.assertEqual((ended.status, ended.json()["complete"]), (200, True), ended.body)
        first, second = sorted(self.recordings(), key=lambda r: r["id"])
        # Steps 30, 35 ... 50 before the restart, 55 ... 70 after it.
        self.assertEqual((first["frames"], second["frames"]), (5, 4))
        self.assertEqual(info(self.download(first))["frames"], 5)
        # Ended for good: a restart does not begin it again, a request does.
        self.again(how="term")
        self.step(s, 10)
        self.assertEqual(len(self.recordings()), 2)
        self.assertEqual(self.service.post(link).status, 201)
        self.assertEqual(self.service.post(link + "/finish").json()["frames"], 1)

    def test_after_a_kill_it_is_listed_repaired_and_continued_without_a_gap(self):
        s = self.service.create(self.SCENE)
        self.step(s, 500)
        # A thread of its own writes them, in blocks.
        end = time.monotonic() + patience(10)
        live, = self.recordings()
        while live["frames"] < 400:
            self.assertLess(time.monotonic(), end, live)
            time.sleep(0.02)
            live, = self.recordings()
        self.assertEqual((live["id"], live["session"], live["state"], live["title"]), (s["id"], s["id"], "live", "a rope"))
        self.assertEqual(self.service.get(live["links"]["file"]).status, 409)
        self.assertEqual(self.service.request("DELETE", live["links"]["self"]).status, 409)
        self.again()
        repaired, = self.recordings()
        self.assertEqual((repaired["id"], repaired["state"]), (s["id"], "repaired"))
        self.assertGreaterEqual(repaired["frames"], live["frames"])
        self.assertEqual(info(self.download(repaired))["frames"], repaired["frames"])
        part = self.service.get(repaired["links"]["file"], {"Range": "bytes=0-7"})
        self.assertEqual((part.status, part.body), (206, b"\x89HDF\r\n\x1a\n"))
        self.assertEqual(self.service.get(s["links"]["recording"]).status, 200)
        # The session goes on, and so does its recording, in a file of its own.
        self.step(s, 250)
        finished = self.service.post(s["links"]["recording"] + "/finish")
        self.assertEqual(finished.status, 200, finished.body)
        first, second = self.recordings()
        self.assertEqual((first, second["id"], second["state"]), (repaired, s["id"] + ".2", "finished"))
        self.assertEqual(first["frames"] + second["frames"], 751)
        self.assertEqual(self.frames_of(first) + self.frames_of(second), list(range(751)))

    def frames_of(self, recording):
        """Steps of its frames, as any reader of HDF5 finds them."""
        path = self.download(recording)
        code = "import h5py, json, sys; print(json.dumps(h5py.File(sys.argv[1])['clock/step'][:].tolist()))"
        done = subprocess.run([PYTHON, "-c", code, str(path)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_frames_beyond_what_anybody_was_told_stay_those_of_the_session(self):
        s = self.service.create(self.SCENE)
        self.step(s, 5)
        self.service.post(s["links"]["play"], {"speed": 100})
        # Nobody asks where it stands; the recording alone says that it went on.
        deadline = time.monotonic() + patience(60)
        while self.recordings()[0]["frames"] < 400 and time.monotonic() < deadline:
            time.sleep(0.05)
        self.again()
        repaired, = self.recordings()
        self.assertGreaterEqual(repaired["frames"], 400)
        now = self.service.get(s["links"]["self"]).json()
        self.assertGreaterEqual(now["step"], repaired["frames"] - 1)
        self.service.post(s["links"]["recording"] + "/finish")
        self.assertEqual(sum(r["frames"] for r in self.recordings()), now["step"] + 1)

    def test_a_second_file_that_came_to_no_frame_begins_nothing_again(self):
        s = self.service.create(self.SCENE)
        self.step(s, 300)
        self.again()
        # Some frames for a new file, too few to be durable.
        self.step(s, 70)
        second = pathlib.Path(self.data) / (s["id"] + ".2.vtkhdf")
        deadline = time.monotonic() + patience(20)
        while not second.exists() and time.monotonic() < deadline:  # another thread makes it
            time.sleep(0.02)
        self.kill()
        for kept in (0, 1000):
            second.write_bytes(second.read_bytes()[:kept])
            second.with_name(second.name + ".chunks").unlink(missing_ok=True)
            self.start()
            self.step(s, 10)
            self.kill()
        self.start()
        self.service.post(s["links"]["recording"] + "/finish")
        frames = sum((self.frames_of(r) for r in self.recordings() if r["state"] != "damaged"), [])
        self.assertEqual(frames, list(range(self.look(s)["step"] + 1)))

    def test_an_orderly_end_and_idleness_close_it_and_it_goes_on(self):
        s = self.service.create(self.SCENE)
        self.step(s, 10)
        self.again("--session-ttl", "1", how="term")
        closed, = self.recordings()
        self.assertEqual((closed["state"], closed["frames"]), ("closed", 11))
        self.step(s, 10)
        end = time.monotonic() + patience(10)
        while len([r for r in self.recordings() if r["state"] == "closed"]) < 2 and time.monotonic() < end:
            time.sleep(0.1)
        self.assertEqual([(r["state"], r["frames"]) for r in self.recordings()], [("closed", 11), ("closed", 10)])
        # Looking at the session begins nothing.
        self.look(s)
        self.assertEqual(len(self.recordings()), 2)
        self.step(s, 5)
        self.service.post(s["links"]["recording"] + "/finish")
        parts = self.recordings()
        self.assertEqual(sum((self.frames_of(r) for r in parts), []), list(range(26)))
        # Finished is finished.
        self.again()
        self.step(s, 5)
        self.assertEqual(len(self.recordings()), 3)

    def test_bodies_that_merge_leave_the_recording(self):
        pair = {"time": {"dt": 0.01, "duration": 1}, "systems": [{"type": "nbody", "id": "n", "gravitational_constant": 0, "masses": [1, 1, 1],
                "radii": [0.1, 0.1, 0.1], "positions": [[0, 0, 0], [1, 0, 0], [0, 3, 0]], "velocities": [[0, 0, 0], [-1.6, 0, 0], [0, 0, 0]],
                "collisions": {"response": "merge"}}]}
        with tempfile.TemporaryDirectory() as folder:
            scene, file, table = (os.path.join(folder, name) for name in ("s.json", "s.vtkhdf", "s"))
            pathlib.Path(scene).write_text(json.dumps(pair))
            done = subprocess.run([BINARY, "run", scene, "-o", file], capture_output=True, text=True, timeout=patience(60))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(info(file)["frames"], 101)
            done = subprocess.run([BINARY, "export", file, "--format", "csv", "-o", table], capture_output=True, text=True, timeout=patience(60))
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = [line.split(",")[:2] for line in pathlib.Path(table + ".csv").read_text().splitlines()[1:]]
            self.assertEqual([sum(step == at for step, _ in rows) for at in ("0", "100")], [3, 2], rows[:4])

    def test_never_overwritten(self):
        path = "/v1/sessions/%s" % uuid.uuid4()
        links = self.service.request("PUT", path, self.SCENE).json()["links"]
        self.service.post(links["step"], {"steps": 100})
        self.service.post(links["recording"] + "/finish")
        self.assertEqual(self.service.request("DELETE", path).status, 204)
        first, = self.recordings()
        again = self.service.request("PUT", path, self.SCENE)
        self.assertEqual((again.status, again.json()["step"]), (201, 0))
        second = self.recordings()[1]
        self.assertEqual((self.recordings()[0], second["id"]), (first, first["id"] + ".2"))
        self.assertEqual(info(self.download(first))["frames"], 101)
        self.service.post(links["recording"] + "/finish")
        self.assertEqual(self.service.request("DELETE", first["links"]["self"]).status, 204)
        self.assertEqual(self.recordings(), [self.service.get("/v1/recordings/" + second["id"]).json()])
        self.assertEqual(self.service.get(first["links"]["self"]).status, 404)

    def test_pages(self):
        sessions = sorted(self.service.create(self.SCENE)["id"] for _ in range(5))
        page = self.service.get("/v1/recordings?limit=3").json()
        rest = self.service.get("/v1/recordings?limit=3&page_token=" + page["next_page_token"]).json()
        self.assertEqual([r["id"] for r in page["recordings"] + rest["recordings"]], sessions)
        self.assertEqual(self.service.get("/v1/recordings?page_token=x").status, 400)

    def test_the_quota_refuses_new_ones(self):
        self.again("--max-recordings", "0.02")
        s = self.service.create(self.SCENE)
        self.step(s, 200)
        self.service.post(s["links"]["recording"] + "/finish")
        refused = self.service.post("/v1/sessions", self.SCENE)
        self.assertEqual((refused.status, refused.json()["code"]), (429, "quota_exceeded"))
        self.assertEqual(self.service.post("/v1/sessions", ROPE).status, 201)
        self.service.request("DELETE", "/v1/recordings/" + s["id"])
        self.assertEqual(self.service.post("/v1/sessions", self.SCENE).status, 201)

    def test_retention_when_it_is_asked_for(self):
        s = self.service.create(self.SCENE)
        self.service.post(s["links"]["recording"] + "/finish")
        self.again("--keep-recordings", "1s", "--session-ttl", "1")
        end = time.monotonic() + patience(10)
        while self.recordings() and time.monotonic() < end:
            time.sleep(0.1)
        self.assertEqual(self.recordings(), [])


class Failures(Restarted):
    def test_a_create_whose_recording_fails_leaves_nothing(self):
        path = "/v1/sessions/%s" % uuid.uuid4()
        scene = {**ROPE, "recording": {"fields": ["colour"]}}
        refused = self.service.request("PUT", path, scene)
        self.assertEqual((refused.status, refused.json()["errors"][0]["pointer"]), (422, "/recording/fields/0"))
        # Names that links stand at are taken: what they lead to is not written to.
        ids = [path.rsplit("/", 1)[1]]
        target = pathlib.Path(self.data).with_suffix(".elsewhere")
        for name in ids:
            self.assertEqual(self.service.get("/v1/sessions/" + name).json()["code"], "unknown_session")
            self.assertEqual([p.name for p in pathlib.Path(self.data).rglob(name + "*")], [])
        self.assertEqual(self.service.get("/v1/recordings").json()["recordings"], [])
        for ending in (".vtkhdf", ".vtkhdf.chunks"):
            ids.append(str(uuid.uuid4()))
            os.symlink(target, pathlib.Path(self.data) / (ids[-1] + ending))
        for name in ids:
            made = self.service.request("PUT", "/v1/sessions/" + name, {**ROPE, "recording": {}})
            self.assertEqual(made.status, 201, made.body)
            self.service.post(made.json()["links"]["step"], {"steps": 3})
            done = self.service.post(made.json()["links"]["recording"] + "/finish").json()
            self.assertEqual((done["frames"], done["id"]), (4, name if name == ids[0] else name + ".2"))
        self.assertFalse(target.exists())

    def small_disk(self, size):
        folder = tempfile.mkdtemp(prefix="truestep")
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=" + size, "tmpfs", folder], capture_output=True).returncode:
            self.skipTest("mounting a small disk needs root")
        self.addCleanup(subprocess.run, ["umount", "-l", folder])
        return folder

    def test_frames_that_a_full_disk_swallowed_are_not_hidden_by_a_restart(self):
        self.kill()
        self.data = self.small_disk("8m")
        self.start()
        cloth = {"time": {"dt": 0.004, "duration": 1000}, "recording": {},
                 "systems": [{"type": "mass_spring", "id": "cloth", "pinned": ["first"], "cloth_grid": {"nx": 40, "ny": 40}}]}
        s = self.service.create(cloth)
        self.step(s, 20)
        filler = pathlib.Path(self.data) / "filler"
        filler.write_bytes(bytes(5 << 20))
        while "not_recorded_because" not in self.look(s):
            self.step(s, 10)
        filler.unlink()
        # There is room again: states are saved, and those from before the last frame are removed.
        end = time.monotonic() + patience(30)
        full = self.look(s)["step"]
        while (self.newest_state(s) <= full or (self.folder(s) / "log.0").exists()) and time.monotonic() < end:
            self.step(s, 200)
        step = self.step(s, 7)["step"]
        self.again()
        now = self.look(s)
        self.assertEqual(now["step"], step)
        first, second = self.service.get("/v1/recordings").json()["recordings"]
        self.assertEqual(first["state"], "incomplete", first)
        self.assertIn("are missing", first["note"])
        self.assertEqual(second["state"], "live", second)
        done = self.service.post(s["links"]["recording"] + "/finish").json()
        self.assertEqual((done["id"], done["frames"]), (second["id"], step - now["restored"]["from_step"] + 1))

    def test_a_playing_session_pauses_when_its_recording_ends_for_want_of_room(self):
        self.kill()
        self.data = self.small_disk("3m")
        self.start()
        cloth = {"time": {"dt": 0.004, "duration": 1000}, "recording": {},
                 "systems": [{"type": "mass_spring", "id": "cloth", "pinned": ["first"], "cloth_grid": {"nx": 40, "ny": 40}}]}
        s = self.service.create(cloth)
        self.assertNotIn("not_recorded_because", s)
        stream = Socket(self.service, s["links"]["stream"], "truestep.v1.json")
        self.addCleanup(stream.close)
        self.assertEqual(self.service.post(s["links"]["play"], {"speed": 10}).status, 200)
        stream.socket.settimeout(patience(60))
        event = stream.message("event")
        self.assertEqual(event["kind"], "recording_incomplete", event)
        now = self.look(s)
        self.assertEqual(now["status"], "paused")
        self.assertIn("full", now["not_recorded_because"])
        row, = self.service.get("/v1/recordings").json()["recordings"]
        self.assertEqual(row["state"], "incomplete")
        # Steps that are asked for go on, unrecorded.
        self.assertEqual(self.step(s, 5)["step"], now["step"] + 5)

    def test_what_was_recorded_before_the_disk_was_full_can_be_had(self):
        self.kill()
        self.data = self.small_disk("4m")
        self.start()
        cloth = {"time": {"dt": 0.004, "duration": 1000}, "recording": {},
                 "systems": [{"type": "mass_spring", "id": "cloth", "pinned": ["first"], "cloth_grid": {"nx": 40, "ny": 40}}]}
        s = self.service.create(cloth)
        last = None
        for _ in range(60):
            last = self.step(s, 10)
            row, = self.service.get("/v1/recordings").json()["recordings"]
            if row["state"] == "incomplete":
                break
        self.assertEqual(row["state"], "incomplete")
        self.assertGreater(row["frames"], 100)
        # The simulation goes on.
        self.assertEqual(self.step(s, 1)["step"], last["step"] + 1)
        done = self.service.post(s["links"]["recording"] + "/finish")
        self.assertEqual(done.status, 200, done.body)
        self.assertFalse(done.json()["complete"])
        self.assertGreaterEqual(done.json()["frames"], row["frames"])
        answer = self.service.get(s["links"]["recording"])
        self.assertEqual(answer.status, 200)
        with tempfile.NamedTemporaryFile(suffix=".vtkhdf") as file:
            file.write(answer.body)
            file.flush()
            self.assertEqual(info(file.name)["frames"], done.json()["frames"])
            code = "import h5py, sys; f = h5py.File(sys.argv[1]); n = len(f['clock/step']); f['particles/cloth/position/value'][n - 1]; print(n)"
            read = subprocess.run([PYTHON, "-c", code, file.name], capture_output=True, text=True)
            self.assertEqual((read.returncode, read.stdout.strip()), (0, str(done.json()["frames"])), read.stderr)

    def test_a_session_on_a_full_disk_goes_on_and_is_kept_again_when_there_is_room(self):
        self.kill()
        self.data = self.small_disk("1m")
        self.start()
        s = self.service.create(ROPE)
        self.step(s, 5)
        filler = pathlib.Path(self.data) / "filler"
        with open(filler, "wb", buffering=0) as f:
            try:
                while True:
                    f.write(b"x" * 4096)
            except OSError:
                pass
        # The log has some room left in its last block. From where it ends, what cannot be kept is not carried out.
        statuses = [self.service.post(s["links"]["commands"], PUSH).status for _ in range(200)]
        self.assertLessEqual(set(statuses), {202, 507})
        self.assertEqual(statuses[-1], 507)
        before = self.look(s)
        self.assertFalse(before["kept"])
        self.assertEqual(self.service.post(s["links"]["commands"], PUSH).status, 507)
        self.assertEqual(self.look(s)["state_hash"], before["state_hash"])
        self.step(s, 5)
        filler.unlink()
        time.sleep(1.1)
        self.step(s, 5)
        now = self.look(s)
        self.assertTrue(now["kept"])
        self.assertEqual(self.service.post(s["links"]["commands"], PUSH).status, 202)
        self.step(s, 5)
        now = self.look(s)
        self.again()
        self.assertEqual(self.look(s)["state_hash"], now["state_hash"])


if __name__ == "__main__":
    unittest.main()
