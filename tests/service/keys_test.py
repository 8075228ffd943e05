"""Keys own what was made with them; who guesses waits; a file of keys that changes counts at once."""
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

from cases import OSCILLATOR
from harness import BINARY, Service, Socket
from patience import patience

STUDY = {"kind": "convergence", "scene": {**OSCILLATOR, "time": {"dt": 0.05, "duration": 1}}}


def bearer(key):
    return {"Authorization": "Bearer " + key}


ALICE, BOB, ROOT, WRONG = (bearer(k) for k in ("alice-key-of-many-letters", "bob-key-of-many-letters", "root-key-of-many-letters", "no-key-of-anybody-here"))


class Keyed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "keys"
        self.file.write_text("alice alice-key-of-many-letters\nbob bob-key-of-many-letters  # a comment\nroot root-key-of-many-letters admin\n")
        self.service = Service("--api-key-file", str(self.file))
        self.addCleanup(self.service.stop)

    def call(self, method, path, who, body=None, **more):
        return self.service.request(method, path, body, {**who, **more})

    def create(self, who, body=OSCILLATOR, **more):
        answer = self.call("POST", "/v1/sessions", who, body, **more)
        self.assertEqual(answer.status, 201, answer.body)
        return answer.json()


class Ownership(Keyed):
    def test_no_operation_reaches_what_another_key_made(self):
        session = self.create(ALICE, {**OSCILLATOR, "recording": {}})
        study = self.call("POST", "/v1/studies", ALICE, STUDY).json()
        snapshot = self.call("POST", session["links"]["snapshots"], ALICE, {}).json()["id"]
        names = {"sid": snapshot, "step": "0"}
        tried = 0
        for path, methods in self.service.get("/openapi.json").json()["paths"].items():
            if "{id}" not in path:
                continue
            kind = "operation" if "/operations/" in path else "session"
            target = path.format(id=(study if kind == "operation" else session)["id"], **names)
            for method in sorted(methods, key=lambda m: m == "delete"):
                if path.endswith("/stream"):
                    socket = Socket(self.service, target, headers=["Authorization: Bearer bob-key-of-many-letters"])
                    self.assertEqual(socket.status, 404, path)
                    socket.close()
                    continue
                body = OSCILLATOR if method == "put" else {} if method == "post" else None
                answer = self.call(method.upper(), target, BOB, body)
                self.assertEqual((answer.status, answer.json()["code"]), (404, "unknown_" + kind), (method, path))
                tried += 1
        self.assertGreater(tried, 25)
        # The control: the owner and an admin reach all of it, and nothing has changed.
        for who in (ALICE, ROOT):
            self.assertEqual(self.call("GET", session["links"]["self"], who).json()["step"], 0)
            self.assertEqual(self.call("GET", study["links"]["self"], who).status, 200)
            self.assertEqual(self.call("GET", session["links"]["snapshots"] + "/" + snapshot, who).status, 200)

    def test_lists_show_what_is_ones_own(self):
        mine = {self.create(who)["id"]: who for who in (ALICE, BOB, ALICE)}
        self.call("POST", "/v1/studies", ALICE, STUDY)

        def seen(who, path, member):
            return {x["id"] for x in self.call("GET", path, who).json()[member]}
        for who, count in ((ALICE, 2), (BOB, 1), (ROOT, 3)):
            found = seen(who, "/v1/sessions", "sessions")
            self.assertEqual(len(found), count)
            self.assertTrue(who is ROOT or all(mine[i] is who for i in found))
            self.assertEqual(len(seen(who, "/v1/operations", "operations")), 0 if who is BOB else 1)
        # Pages are full of what may be seen.
        page = self.call("GET", "/v1/sessions?limit=2", ALICE).json()
        self.assertEqual(len(page["sessions"]), 2)

    def test_idempotency_keys_of_two_callers_are_two(self):
        key = {"Idempotency-Key": "one"}
        first, second = (self.create(who, **key)["id"] for who in (ALICE, BOB))
        self.assertNotEqual(first, second)
        self.assertEqual(self.create(ALICE, **key)["id"], first)

    def test_ones_own_id_can_be_taken_by_one_caller(self):
        path = "/v1/sessions/01234567-89ab-4cde-8f01-23456789abcd"
        answers = [self.call("PUT", path, who, OSCILLATOR).status for who in (ALICE, BOB, ALICE, ROOT)]
        self.assertEqual(answers, [201, 404, 200, 200])


class Guessing(Keyed):
    def test_who_guesses_waits_and_who_works_there_does_not(self):
        path = "/v1/systems"
        self.assertEqual(self.call("GET", path, ALICE).status, 200)
        answers = [self.call("GET", path, WRONG) for _ in range(20)]
        statuses = [a.status for a in answers]
        self.assertEqual(statuses[:10], [401] * 10)
        self.assertEqual(statuses[-1], 429)
        self.assertEqual(answers[-1].json()["code"], "too_many_keys")
        self.assertTrue(1 <= int(answers[-1].headers["Retry-After"]) <= 60)
        # One who was here before goes on; a key that was never used from here is not even looked at.
        self.assertEqual(self.call("GET", path, ALICE).status, 200)
        self.assertEqual(self.call("GET", path, BOB).status, 429)
        self.assertEqual(self.service.get("/healthz").status, 200)


class Changing(Keyed):
    def wait_for(self, who, status):
        deadline = time.monotonic() + patience(6)
        while (now := self.call("GET", "/v1/systems", who).status) != status and time.monotonic() < deadline:
            time.sleep(0.5)
        self.assertEqual(now, status)

    def replace(self, text):
        new = self.file.with_suffix(".new")
        new.write_text(text)
        os.replace(new, self.file)

    def test_keys_come_and_go_without_a_restart(self):
        stream = Socket(self.service, self.create(BOB)["links"]["stream"], "truestep.v1.json", ["Authorization: Bearer bob-key-of-many-letters"])
        stream.message("hello")
        session = self.create(ALICE)
        self.replace("alice alice-new-of-many-letters\ncarol carol-key-of-many-letters\n")
        self.wait_for(bearer("carol-key-of-many-letters"), 200)
        self.assertEqual(self.call("GET", "/v1/systems", BOB).status, 401)
        # What belongs to a name stays with its new key; a stream of a key that is gone ends.
        self.assertEqual(self.call("GET", session["links"]["self"], bearer("alice-new-of-many-letters")).status, 200)
        with self.assertRaisesRegex(ConnectionError, "1008"):
            while True:
                stream.message("frame")

    def test_a_file_that_cannot_be_used_changes_nothing(self):
        self.wait_for(ALICE, 200)
        for text in ("# nobody\n", "alice alice-key-of-many-letters king\n", "alice a\n", "bob sha256:abc\n", "bob bob-key-of-many-lett"):
            self.replace(text)
            time.sleep(1.5)
            self.assertEqual(self.call("GET", "/v1/systems", ALICE).status, 200, text)
        self.file.unlink()
        time.sleep(1.5)
        self.assertEqual(self.call("GET", "/v1/systems", ALICE).status, 200)

    def test_a_fifo_in_place_of_the_file_stops_nothing(self):
        self.wait_for(ALICE, 200)
        self.file.unlink()
        os.mkfifo(self.file)
        time.sleep(1.5)
        for _ in range(5):
            self.assertEqual(self.call("GET", "/v1/systems", ALICE).status, 200)
        self.assertEqual(self.service.stop(), 0)
        # A start with it is refused, not waited for.
        refused = subprocess.run([BINARY, "serve", "--port", "0", "--api-key-file", str(self.file)], capture_output=True, text=True,
                                 timeout=patience(20))
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("not a regular file", refused.stderr)


class Insecure(unittest.TestCase):
    def test_without_keys_the_host_is_checked_all_the_same(self):
        service = Service("--host", "0.0.0.0", "--insecure")
        self.addCleanup(service.stop)
        service.address = ("127.0.0.1", service.address[1])

        def status(host, **headers):
            return service.get("/v1/systems", {"Host": host, **headers}).status
        self.assertEqual(status("127.0.0.1"), 200)
        self.assertEqual(status("192.0.2.7:8080"), 200, "an address is no name that could be bound again")
        self.assertEqual(status("evil.example"), 421)
        self.assertEqual(status("evil.example", Origin="http://evil.example"), 421)
        self.assertEqual(status("127.0.0.1", Origin="http://evil.example"), 403)


if __name__ == "__main__":
    unittest.main()
