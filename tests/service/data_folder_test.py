"""A data folder belongs to one server: a second one says who holds it and touches nothing."""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest
import uuid

from cases import OSCILLATOR
from harness import BINARY, Service
from patience import patience

RECORDED = {**OSCILLATOR, "recording": {}}


def second(folder):
    """A server on a folder that is in use: it ends by itself, and one that listens instead is ended."""
    process = subprocess.Popen([BINARY, "serve", "--port", "0", "--data-dir", folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    with process:
        listens = "listening on " in process.stdout.readline()
        if listens:
            process.terminate()
        said = process.communicate(timeout=patience(20))[1]
        return process.returncode, "listens" if listens else said


def contents(folder):
    return {str(p): hashlib.sha256(p.read_bytes()).hexdigest() for p in pathlib.Path(folder).rglob("*") if p.is_file()}


class DataFolder(unittest.TestCase):
    def setUp(self):
        self.service = Service()
        self.addCleanup(self.service.stop)

    def test_a_second_server_says_who_holds_the_folder(self):
        code, said = second(self.service.data)
        self.assertEqual(code, 5, said)
        self.assertIn("process %d on " % self.service.process.pid, said)
        self.assertIn(self.service.data, said)

    def test_a_live_recording_is_not_repaired(self):
        session = self.service.create(RECORDED)
        self.service.post(session["links"]["step"], {"steps": 20})
        # Twice: between the two nothing is written any more.
        before = contents(self.service.data)
        while before != (before := contents(self.service.data)):
            pass
        second(self.service.data)
        self.assertEqual(contents(self.service.data), before)
        self.service.post(session["links"]["step"], {"steps": 20})
        finished = self.service.post(session["links"]["recording"] + "/finish")
        self.assertEqual((finished.status, finished.json()["frames"]), (200, 41))

    def test_a_folder_is_free_when_its_server_has_ended_or_was_killed(self):
        self.service.process.kill()
        self.service.process.wait(patience(10))
        code, said = second(self.service.data)
        self.assertEqual((code, said), (0, "listens"))
        self.assertEqual(second(self.service.data), (0, "listens"))

    def test_a_folder_whose_lock_file_is_gone_is_held_all_the_same(self):
        (pathlib.Path(self.service.data) / "server.lock").unlink()
        code, said = second(self.service.data)
        self.assertEqual(code, 5, said)
        self.assertIn("is in use by another process", said)


class Links(unittest.TestCase):
    """What is no file of the folder's own is not read, and nothing waits for it."""

    def setUp(self):
        self.data = tempfile.mkdtemp(prefix="truestep")
        self.addCleanup(shutil.rmtree, self.data, ignore_errors=True)
        self.secret = pathlib.Path(self.data).with_suffix(".secret")
        self.secret.write_text('{"a secret": 1}')
        self.addCleanup(self.secret.unlink)
        self.service = Service(data=self.data)
        self.addCleanup(self.end)

    def end(self):
        self.service.process.terminate()
        self.assertEqual(self.service.process.wait(patience(20)), 0)
        self.service.process.stdout.close()

    def again(self):
        self.end()
        self.service = Service(data=self.data)

    def test_links_are_not_followed(self):
        session = self.service.create(RECORDED)
        self.service.post(session["links"]["step"], {"steps": 3})
        self.assertEqual(self.service.post(session["links"]["recording"] + "/finish").status, 200)
        self.assertEqual(self.service.get(session["links"]["recording"]).status, 200)
        file = pathlib.Path(self.data) / (session["id"] + ".vtkhdf")
        file.unlink()
        file.symlink_to(self.secret)
        digest = hashlib.sha256(self.secret.read_bytes()).hexdigest()
        (pathlib.Path(self.data) / "assets").mkdir()
        asset = pathlib.Path(self.data) / "assets" / (digest + ".json")
        asset.symlink_to(self.secret)
        for _ in range(2):
            for path in (session["links"]["recording"], "/v1/recordings/%s/file" % session["id"], "/v1/assets/" + digest):
                answer = self.service.get(path)
                self.assertEqual(answer.status, 404, (path, answer.body))
                self.assertNotIn(b"a secret", answer.body)
            self.again()
        # An asset that is put there is one, and the link's target stays as it was.
        put = self.service.request("PUT", "/v1/assets/" + digest, self.secret.read_bytes(), {"Content-Type": "application/json"})
        self.assertEqual(put.status, 201, put.body)
        self.assertFalse(asset.is_symlink())
        self.assertEqual(self.service.get("/v1/assets/" + digest).json(), {"a secret": 1})

    def test_a_fifo_keeps_no_server_from_starting(self):
        session = self.service.create(RECORDED)
        self.service.post(session["links"]["step"], {"steps": 3})
        self.end()
        digest = "0" * 64
        names = [str(uuid.uuid4()) for _ in range(5)]
        folder = pathlib.Path(self.data)
        (folder / "assets").mkdir()
        for name in names[:2]:
            (folder / "sessions" / name).mkdir()
        kept = folder / "sessions" / session["id"]
        fifos = [folder / (names[2] + ".vtkhdf"), folder / (names[3] + ".vtkhdf.json"), folder / "sessions" / names[0] / "about",
                 folder / "sessions" / names[4], folder / "assets" / (digest + ".json"), kept / "log.99", kept / "state.98.3"]
        # A recording that was not finished is looked at with its chunk log.
        (folder / (names[1] + ".vtkhdf")).write_bytes(b"not a recording")
        fifos.append(folder / (names[1] + ".vtkhdf.chunks"))
        for path in fifos:
            os.mkfifo(path)
        self.service = Service(data=self.data)
        end = time.monotonic() + patience(20)
        while self.service.get("/readyz").status != 200 and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(self.service.get("/v1/assets/" + digest).status, 404)
        for path in ("/v1/sessions", "/v1/recordings", "/healthz"):
            self.assertEqual(self.service.get(path).status, 200)
        for name in names:
            self.assertIn(self.service.get("/v1/sessions/" + name).status, (404, 409))
            self.assertIn(self.service.get("/v1/recordings/%s/file" % name).status, (200, 404, 409))
        # The session with foreign files beside its own says what it makes of them, at once.
        self.assertIn(self.service.get(session["links"]["self"]).status, (200, 409))


class Gone(unittest.TestCase):
    """The folder disappears while the server runs."""

    def setUp(self):
        self.service = Service()
        self.addCleanup(self.service.stop)
        self.session = self.service.create(RECORDED)
        self.service.post(self.session["links"]["step"], {"steps": 3})

    def refused(self, answer):
        self.assertEqual((answer.status, answer.json()["code"]), (503, "folder_io"), answer.body)
        self.assertIn("data folder", answer.json()["detail"])

    def see_that_it_is_gone(self):
        body = json.dumps([1]).encode()
        self.refused(self.service.get("/readyz"))
        self.refused(self.service.post("/v1/sessions", OSCILLATOR))
        self.refused(self.service.post("/v1/sessions", RECORDED))
        self.refused(self.service.post(self.session["links"]["self"] + "/branch"))
        self.refused(self.service.post(self.session["links"]["snapshots"]))
        self.refused(self.service.request("PUT", "/v1/assets/" + hashlib.sha256(body).hexdigest(), body,
                                          {"Content-Type": "application/json"}))
        # What was there goes on in memory, and says that it is not kept.
        self.assertEqual(self.service.post(self.session["links"]["step"], {"steps": 3}).status, 200)
        now = self.service.get(self.session["links"]["self"]).json()
        self.assertEqual((now["step"], now["kept"]), (6, False))
        self.assertIn("not_kept_because", now)
        self.assertEqual(self.service.get("/healthz").status, 200)
        self.assertEqual(len(self.service.get("/v1/sessions").json()["sessions"]), 1, "nothing that was refused is there")

    def test_a_folder_that_is_removed(self):
        shutil.rmtree(self.service.data)
        self.see_that_it_is_gone()
        self.assertEqual(self.service.request("DELETE", self.session["links"]["self"]).status, 204)

    def test_a_folder_that_is_replaced(self):
        shutil.rmtree(self.service.data)
        os.mkdir(self.service.data)
        self.addCleanup(shutil.rmtree, self.service.data, ignore_errors=True)
        self.see_that_it_is_gone()
        self.assertEqual(os.listdir(self.service.data), [], "it may be another server's")


if __name__ == "__main__":
    unittest.main()
