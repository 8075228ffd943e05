"""A data folder belongs to one server: a second one says who holds it and touches nothing."""
import hashlib
import pathlib
import subprocess
import unittest

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


if __name__ == "__main__":
    unittest.main()
