"""What swaps something of the data folder for a link while the server runs leads nothing out of the folder: not a byte beside it is read
in an answer, written, renamed or removed. Every place of the folder is swapped, and everything that touches files is asked then."""
import hashlib
import json
import os
import pathlib
import shutil
import tempfile
import unittest

from cases import OSCILLATOR
from harness import Service
from patience import patience

RECORDED = {**OSCILLATOR, "recording": {}}
SECRET = b"what lies beside the folder"
PUT = json.dumps([1, 2, 3]).encode()
NEW = json.dumps([4, 5, 6]).encode()


def digest(body):
    return hashlib.sha256(body).hexdigest()


def contents(place):
    """Every name below, with a file's bytes."""
    return {str(p.relative_to(place)): p.read_bytes() if p.is_file() else None for p in [place, *place.rglob("*")]}


class Swapped(unittest.TestCase):
    def setUp(self):
        self.around = pathlib.Path(tempfile.mkdtemp(prefix="truestep"))
        self.addCleanup(shutil.rmtree, self.around, ignore_errors=True)
        self.data, self.beside = self.around / "data", self.around / "beside"
        self.data.mkdir()
        self.service = Service(data=str(self.data))
        self.addCleanup(self.end)
        self.live = self.service.create(RECORDED)
        self.done = self.service.create(RECORDED)
        for session in (self.live, self.done):
            self.service.post(session["links"]["step"], {"steps": 5})
            self.service.post(session["links"]["snapshots"])
        self.service.post(self.done["links"]["recording"] + "/finish")
        self.put(PUT)

    def end(self):
        if self.service.process.poll() is None:
            self.service.process.terminate()
        self.assertEqual(self.service.process.wait(patience(20)), 0)
        self.service.process.stdout.close()

    def put(self, body):
        return self.service.request("PUT", "/v1/assets/" + digest(body), body, {"Content-Type": "application/json"})

    def ask(self):
        """Everything that reads, writes or removes files; nothing of what lies beside is in an answer."""
        ask = self.service.request
        for session in (self.live, self.done):
            links = session["links"]
            answers = [
                ask("GET", links["recording"]), ask("GET", "/v1/recordings/%s/file" % session["id"]), ask("GET", "/v1/recordings"),
                ask("POST", links["step"], {"steps": 3}), ask("POST", links["snapshots"], {}), ask("GET", links["snapshots"] + "/step-5"),
                ask("POST", links["snapshots"] + "/step-5/restore", {}), ask("DELETE", links["snapshots"] + "/step-5"),
                ask("POST", links["recording"] + "/finish", {}), ask("GET", links["recording"]),
                ask("POST", links["recording"], {"every": 1}), ask("POST", links["step"], {"steps": 3}),
                ask("DELETE", links["recording"]), ask("DELETE", "/v1/recordings/" + session["id"])]
            for answer in answers:
                self.assertNotIn(SECRET, answer.body)
                self.assertNotEqual(answer.status, 500, answer.body)
        for answer in (ask("GET", "/v1/assets/" + digest(PUT)), self.put(NEW), self.put(PUT), ask("GET", "/v1/assets/" + digest(NEW)),
                       ask("DELETE", "/v1/assets/" + digest(PUT)), ask("DELETE", "/v1/assets/" + digest(NEW)), self.service.post("/v1/sessions", RECORDED)):
            self.assertNotIn(SECRET, answer.body)
            self.assertNotEqual(answer.status, 500, answer.body)
        self.assertIn(ask("DELETE", self.done["links"]["self"]).status, (204, 404, 409, 503))

    def swap(self, *names):
        """A link to a copy takes the place: what the server holds open stays its own, wherever that is moved."""
        place, away = self.data.joinpath(*names), self.around / "away"
        shutil.move(place, away)
        (shutil.copytree if away.is_dir() else shutil.copyfile)(away, self.beside)
        files = [p for p in self.beside.rglob("*") if p.is_file()] if self.beside.is_dir() else [self.beside]
        for file in files:
            kind = place.suffix if file == self.beside else file.suffix
            if kind in (".vtkhdf", ".bin"):
                file.write_bytes(file.read_bytes() + SECRET)
            elif kind == ".json":
                file.write_bytes(b'{"title": "%s"}' % SECRET)
        place.symlink_to(self.beside)
        before = contents(self.beside)
        self.ask()
        self.assertEqual(contents(self.beside), before)
        self.end()
        # The next server meets the link at its start; that of the whole folder is what it is told to use.
        if names:
            self.service = Service(data=str(self.data))
            self.ask()
        self.assertEqual(contents(self.beside), before)

    def test_the_folder_itself(self):
        self.swap()

    def test_the_folder_of_sessions(self):
        self.swap("sessions")

    def test_the_folder_of_assets(self):
        self.swap("assets")

    def test_a_session(self):
        self.swap("sessions", self.live["id"])

    def test_a_session_that_records_no_more(self):
        self.swap("sessions", self.done["id"])

    def test_the_snapshots_of_a_session(self):
        self.swap("sessions", self.live["id"], "snapshots")

    def test_the_description_of_a_session(self):
        self.swap("sessions", self.live["id"], "about")

    def test_the_journal_of_a_session(self):
        self.swap("sessions", self.live["id"], "log.0")

    def test_a_snapshot(self):
        self.swap("sessions", self.live["id"], "snapshots", "step-5.5")

    def test_an_asset(self):
        self.swap("assets", digest(PUT) + ".json")

    def test_whose_an_asset_is(self):
        self.swap("assets", digest(PUT) + ".owners")

    def test_a_recording(self):
        self.swap(self.done["id"] + ".vtkhdf")

    def test_a_recording_that_is_written(self):
        self.swap(self.live["id"] + ".vtkhdf")

    def test_the_chunk_log_of_a_recording(self):
        self.swap(self.live["id"] + ".vtkhdf.chunks")

    def test_the_note_of_a_recording(self):
        self.swap(self.done["id"] + ".vtkhdf.json")


if __name__ == "__main__":
    unittest.main()
