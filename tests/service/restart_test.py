"""What a server that ends, by whatever means, leaves to the next one on its folder: sessions at the hash that they would have
had, their snapshots, and whose they are."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest
import uuid

from cases import OSCILLATOR
from harness import Socket
from patience import patience
from restarted import PUSH, ROPE, Restarted


class Sessions(Restarted):
    COURSE = (("step", 37), ("command", PUSH), ("step", 20), ("command", {**PUSH, "impulse": [0.02, 0, 0]}), ("step", 1))

    def test_what_was_acknowledged_is_there_after_a_kill(self):
        s = self.service.create(ROPE)
        self.follow(s, self.COURSE)
        before = self.look(s)
        self.kill()
        saved = self.newest_state(s)
        self.start()
        listed = self.service.get("/v1/sessions").json()["sessions"]
        self.assertEqual([row["id"] for row in listed], [s["id"]])
        after = self.look(s)
        self.assertEqual((after["step"], after["state_hash"]), (58, before["state_hash"]))
        self.assertEqual(after["status"], "paused")
        # The start, unless steps took so long here that a later state was worth writing.
        self.assertEqual(after["restored"], {"from_step": saved, "step": 58, "complete": True})
        self.assertEqual((before["step"], before["state_hash"]), self.uninterrupted(ROPE, self.COURSE))
        # And on from there, commands before and after the kill alike.
        more = (("command", PUSH), ("step", 30))
        self.follow(s, more)
        self.again()
        now = self.look(s)
        self.assertEqual((now["step"], now["state_hash"]), self.uninterrupted(ROPE, self.COURSE + more))

    def test_a_kill_after_much_work_resumes_from_the_newest_saved_state(self):
        s = self.service.create(ROPE)
        end = time.monotonic() + patience(20)
        while self.newest_state(s) == 0 and time.monotonic() < end:
            self.step(s, 2000)
        # Written while the session had more to do: the log leads on from it.
        before = self.step(s, 7)
        self.kill()
        saved = self.newest_state(s)
        self.assertTrue(0 < saved < before["step"], saved)
        self.start()
        now = self.look(s)
        self.assertEqual(now["state_hash"], before["state_hash"])
        self.assertEqual(now["restored"], {"from_step": saved, "step": before["step"], "complete": True})

    def test_a_command_that_nobody_stepped_after(self):
        s = self.service.create(ROPE)
        self.step(s, 5)
        self.service.post(s["links"]["commands"], PUSH)
        before = self.look(s)
        self.again()
        self.assertEqual(self.look(s)["state_hash"], before["state_hash"])

    def test_refused_commands_leave_no_trace(self):
        s = self.service.create(ROPE)
        self.step(s, 5)
        for _ in range(2):
            self.assertEqual(self.service.post(s["links"]["commands"], {**PUSH, "index": 4000}).status, 422)
        self.step(s, 5)
        self.assertEqual(self.service.post(s["links"]["commands"], {**PUSH, "index": 4000}).status, 422)
        before = self.look(s)
        for _ in range(2):
            self.again()
            self.assertEqual(self.look(s)["state_hash"], before["state_hash"])
        self.step(s, 1)

    def test_seeks_and_the_future_that_they_went_back_from(self):
        s = self.service.create(ROPE)
        self.follow(s, self.COURSE)
        end = self.look(s)
        self.service.post(s["links"]["self"] + "/seek", {"step": 10})
        at = self.look(s)
        self.again()
        back = self.look(s)
        self.assertEqual((back["step"], back["state_hash"]), (10, at["state_hash"]))
        self.step(s, 48)
        self.assertEqual(self.look(s)["state_hash"], end["state_hash"])

    def test_reset_and_restored_snapshots(self):
        s = self.service.create(ROPE)
        self.follow(s, self.COURSE)
        taken = self.service.post(s["links"]["snapshots"]).json()
        self.step(s, 10)
        self.service.post(s["links"]["reset"])
        start = self.look(s)
        self.again()
        self.assertEqual(self.look(s)["state_hash"], start["state_hash"])
        path = s["links"]["snapshots"] + "/" + taken["id"]
        self.assertEqual(self.service.get(s["links"]["snapshots"]).json()["snapshots"], [{"id": taken["id"], "step": 58}])
        self.assertEqual(self.service.post(path + "/restore").json()["state_hash"], taken["state_hash"])
        self.again()
        self.assertEqual(self.look(s)["state_hash"], taken["state_hash"])
        self.assertEqual(self.service.get(path).status, 200)

    def test_branches_and_scenes_whose_method_was_chosen(self):
        asked = self.service.create({**OSCILLATOR, "accuracy": {"tolerance": 1e-4}})
        hashes = [self.step(asked, 20)["state_hash"]]
        branch = self.service.post(asked["links"]["self"] + "/branch").json()
        hashes.append(self.step(branch, 7)["state_hash"])
        self.again()
        for session, wanted in zip((asked, branch), hashes):
            now = self.look(session)
            self.assertEqual((now["state_hash"], now["accuracy"]), (wanted, asked["accuracy"]))

    def test_a_playing_session_comes_back_paused_where_it_was_last_seen(self):
        s = self.service.create(ROPE)
        self.service.post(s["links"]["play"], {"speed": 20})
        time.sleep(1)
        seen = self.look(s)
        self.again()
        now = self.look(s)
        self.assertEqual(now["status"], "paused")
        # What was told at the latest a moment before the end; a tenth of a second is told at once.
        self.assertGreater(now["step"], seen["step"] * 0.7)
        step = now["step"]
        self.assertEqual((step, now["state_hash"]), self.uninterrupted(ROPE, (("step", step),)))

    def test_the_first_use_may_be_any(self):
        s = self.service.create(ROPE)
        self.step(s, 9)
        self.again()
        self.assertEqual(self.step(s, 1)["step"], 10)
        self.again()
        stream = Socket(self.service, s["links"]["stream"], "truestep.v1.json")
        self.addCleanup(stream.close)
        self.assertEqual(int(stream.message("frame")["step"]), 10)

    def test_put_of_the_same_id(self):
        path = "/v1/sessions/%s" % uuid.uuid4()
        self.assertEqual(self.service.request("PUT", path, ROPE).status, 201)
        self.service.post(path + "/step", {"steps": 12})
        self.again()
        self.assertEqual(self.service.request("PUT", path, {**ROPE, "name": "another"}).status, 409)
        same = self.service.request("PUT", path, ROPE)
        self.assertEqual((same.status, same.json()["step"], same.json()["restored"]["step"]), (200, 12, 12))

    def test_deleted_is_deleted(self):
        loaded, stored = self.service.create(ROPE), self.service.create(ROPE)
        self.service.request("DELETE", loaded["links"]["self"])
        self.again()
        self.assertEqual(self.service.get(loaded["links"]["self"]).status, 404)
        self.assertEqual(self.service.request("DELETE", stored["links"]["self"]).status, 204)
        self.again()
        self.assertEqual(self.service.get("/v1/sessions").json()["sessions"], [])
        self.assertEqual(list((pathlib.Path(self.data) / "sessions").iterdir()), [])

    def test_an_orderly_end_saves_where_the_sessions_stand(self):
        s = self.service.create(ROPE)
        self.service.post(s["links"]["step"], {"steps": 5000})
        before = self.look(s)
        self.again(how="term")
        now = self.look(s)
        self.assertEqual((now["step"], now["state_hash"]), (5000, before["state_hash"]))
        self.assertEqual(now["restored"]["from_step"], 5000)

    def test_idle_sessions_are_put_away_and_come_back(self):
        self.again("--session-ttl", "1")
        s = self.service.create(ROPE)
        before = self.step(s, 30)
        end = time.monotonic() + patience(10)
        while b"truestep_sessions 0" not in self.service.get("/metrics").body and time.monotonic() < end:
            time.sleep(0.1)
        self.assertIn(b"truestep_sessions 0", self.service.get("/metrics").body)
        now = self.look(s)
        self.assertEqual((now["step"], now["state_hash"]), (30, before["state_hash"]))
        self.assertIn("restored", now)

    def test_without_keeping_it_is_as_if_there_were_no_folder(self):
        kept = self.service.create(ROPE)
        self.again("--keep-sessions", "0", "--session-ttl", "1")
        self.assertEqual(self.service.get(kept["links"]["self"]).status, 404)
        s = self.service.create(ROPE)
        self.assertNotIn("kept", s)
        end = time.monotonic() + patience(10)
        while self.service.get("/v1/sessions").json()["sessions"] and time.monotonic() < end:
            time.sleep(0.3)
        gone = self.service.get(s["links"]["self"])
        self.assertEqual((gone.status, gone.json()["code"]), (410, "session_expired"))
        self.assertEqual([p.name for p in (pathlib.Path(self.data) / "sessions").iterdir()], [kept["id"]])

    def test_retention(self):
        s = self.service.create(ROPE)
        self.again("--keep-sessions", "1s")
        end = time.monotonic() + patience(10)
        while self.service.get("/v1/sessions").json()["sessions"] and time.monotonic() < end:
            time.sleep(0.1)
        self.assertEqual(self.service.get(s["links"]["self"]).status, 404)
        self.assertFalse(self.folder(s).exists())

    def test_the_quota_takes_what_was_unused_longest(self):
        big = {**ROPE, "systems": [{**ROPE["systems"][0], "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 9000}}]}
        sessions = []
        for _ in range(3):
            s = self.service.create(big)
            self.service.post(s["links"]["snapshots"])
            sessions.append(s)
            time.sleep(0.02)
        self.assertGreater(sum(p.stat().st_size for p in self.folder(sessions[0]).rglob("*") if p.is_file()), 400_000)
        self.again("--max-kept", "1", "--session-ttl", "1")
        end = time.monotonic() + patience(10)
        while self.folder(sessions[0]).exists() and time.monotonic() < end:
            time.sleep(0.1)
        left = [row["id"] for row in self.service.get("/v1/sessions").json()["sessions"]]
        self.assertNotIn(sessions[0]["id"], left)
        self.assertIn(sessions[2]["id"], left)


class Damage(Restarted):
    def test_torn_tails_and_damaged_folders(self):
        torn, cut, wild, none = (self.service.create(ROPE) for _ in range(4))
        hashes = {}
        for s in (torn, cut, wild, none):
            self.step(s, 8)
            hashes[s["id"]] = self.look(s)["state_hash"]
        self.kill()
        # What a kill in the middle of a write leaves.
        log = next(self.folder(torn).glob("log.*"))
        with open(log, "ab") as f:
            f.write(log.read_bytes()[-32:-7])
        (self.folder(cut) / "about").write_bytes((self.folder(cut) / "about").read_bytes()[:-40])
        (self.folder(wild) / "about").write_bytes(os.urandom(300))
        shutil.rmtree(self.folder(none))
        self.folder(none).mkdir()
        self.start()
        self.assertEqual(self.look(torn)["state_hash"], hashes[torn["id"]])
        for s in (cut, wild, none):
            answer = self.service.get(s["links"]["self"])
            self.assertEqual((answer.status, answer.json()["code"]), (409, "session_damaged"), answer.body)
            self.assertEqual(self.service.request("DELETE", s["links"]["self"]).status, 204)
        self.step(torn, 4)
        self.again()
        self.assertEqual(self.look(torn)["step"], 12)

    def test_a_log_that_is_damaged_in_its_middle_says_so(self):
        s = self.service.create(ROPE)
        for _ in range(10):
            self.step(s, 1)
            self.service.post(s["links"]["commands"], PUSH)
        self.kill()
        log = next(self.folder(s).glob("log.*"))
        data = bytearray(log.read_bytes())
        data[len(data) // 2] ^= 1
        log.write_bytes(data)
        self.start()
        now = self.look(s)
        self.assertFalse(now["restored"]["complete"])
        self.assertLess(now["step"], 10)

    def test_ten_thousand_folders_hold_nobody_up(self):
        s = self.service.create(ROPE)
        self.kill()
        about = (self.folder(s) / "about").read_text()
        for _ in range(10000):
            name = str(uuid.uuid4())
            folder = pathlib.Path(self.data) / "sessions" / name
            folder.mkdir()
            (folder / "about").write_text(about.replace(s["id"], name))
        begun = time.monotonic()
        self.start()
        self.assertLess(time.monotonic() - begun, patience(3))
        page = self.service.get("/v1/sessions?limit=1000").json()
        self.assertEqual(len(page["sessions"]), 1000)
        self.assertEqual(self.service.get("/v1/sessions/%s" % page["sessions"][500]["id"]).json()["step"], 0)


class Owners(Restarted):
    def setUp(self):
        folder = tempfile.mkdtemp(prefix="truestep")
        self.addCleanup(shutil.rmtree, folder)
        keys = pathlib.Path(folder) / "keys"
        keys.write_text("alice %s\nbob %s\nroot %s admin\n" % ("a" * 20, "b" * 20, "c" * 20))
        self.options = ("--api-key-file", str(keys))
        super().setUp()

    def ask(self, who, method, path, body=None):
        return self.service.request(method, path, body, {"Authorization": "Bearer " + {"alice": "a", "bob": "b", "root": "c"}[who] * 20})

    def test_what_a_key_made_is_its_own_after_a_restart(self):
        s = self.ask("alice", "POST", "/v1/sessions", {**ROPE, "recording": {}}).json()
        self.ask("alice", "POST", s["links"]["step"], {"steps": 100})
        self.again()
        recording = "/v1/recordings/" + s["id"]
        for path in (s["links"]["self"], recording, recording + "/file", s["links"]["recording"]):
            self.assertEqual(self.ask("bob", "GET", path).status, 404, path)
        for path in (s["links"]["self"], recording):
            self.assertEqual(self.ask("bob", "DELETE", path).status, 404, path)
        self.assertEqual(self.ask("bob", "PUT", s["links"]["self"], {**ROPE, "recording": {}}).status, 404)
        for what in ("sessions", "recordings"):
            self.assertEqual(self.ask("bob", "GET", "/v1/" + what).json()[what], [])
            for who in ("alice", "root"):
                self.assertEqual([row["id"] for row in self.ask(who, "GET", "/v1/" + what).json()[what]], [s["id"]])
        self.assertEqual(self.ask("alice", "GET", s["links"]["self"]).json()["step"], 100)


class Load(Restarted):
    def test_kills_under_load(self):
        """A short run of tests/service/restart_kills.py."""
        self.kill()
        script = pathlib.Path(__file__).with_name("restart_kills.py")
        done = subprocess.run(["python3", str(script), "--kills", "5", "--sessions", "6"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.start()


if __name__ == "__main__":
    unittest.main()
