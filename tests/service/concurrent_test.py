"""Many clients at once, and what is whose: no ghost of a failed create, no 500 of a session that somebody deletes, no "shutting
down" of a server that is not, one result for one Idempotency-Key, conditions, quotas per key."""
import json
import pathlib
import random
import tempfile
import threading
import unittest
import uuid

from cases import OSCILLATOR, Case
from harness import Service

SMALL = {"time": {"dt": 0.01}, "systems": [{"type": "mass_spring", "id": "r", "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 8},
                                             "stiffness": 100, "mass": 0.1, "pinned": ["first"]}]}


def at_once(count, f):
    """f(k) of `count` threads; their results, exceptions included."""
    out = [None] * count

    def run(k):
        try:
            out[k] = f(k)
        except Exception as e:
            out[k] = e

    threads = [threading.Thread(target=run, args=(k,)) for k in range(count)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    return out


class Concurrent(Case):
    def test_a_session_that_others_delete(self):
        """Seeded: 40 threads step, seek, snapshot, branch, command, read and delete a few sessions. No answer is of the 5xx."""
        for seed in range(3):
            ids = [self.service.create(SMALL)["id"] for _ in range(6)]
            bad = []

            def client(k):
                choose = random.Random(1000 * seed + k)
                for _ in range(25):
                    s = "/v1/sessions/" + choose.choice(ids)
                    method, path, body = choose.choice((
                        ("POST", "/step", {"steps": 3}), ("POST", "/seek", {"step": choose.randrange(5)}), ("POST", "/snapshots", None),
                        ("POST", "/snapshots/step-0/restore", {}), ("GET", "/snapshots/step-0", None), ("POST", "/branch", {}),
                        ("POST", "/play", {}), ("POST", "/pause", {}), ("GET", "", None), ("GET", "/frames/latest", None),
                        ("POST", "/commands", {"type": "impulse", "system": "r", "index": 3, "impulse": [0, 0, 0.01]}),
                        ("GET", "/bundle", None), ("POST", "/reset", {})) + ((("DELETE", "", None),) if choose.random() < 0.15 else ()))
                    a = self.service.request(method, s + path, body)
                    if a.status >= 500:
                        bad.append((seed, method, path, a.status, a.body[:300]))
                    if method == "POST" and path == "/branch" and a.status == 201:
                        self.service.request("DELETE", "/v1/sessions/" + a.json()["id"])

            failed = [r for r in at_once(40, client) if r is not None]
            self.assertEqual((bad[:3], failed[:3]), ([], []))

    def test_put_and_delete_of_one_id(self):
        """Whoever loses is told so, not that the server ends."""
        scene = {"systems": [{"type": "particles", "id": "p", "positions": [[k, 0, 0] for k in range(4000)], "max_particles": 4000}]}
        for _ in range(6):
            path = "/v1/sessions/" + str(uuid.uuid4())
            answers = at_once(12, lambda k: self.service.request("PUT" if k % 2 else "DELETE", path, scene if k % 2 else None))
            for a in answers:
                self.assertNotIsInstance(a, Exception)
                self.assertLess(a.status, 500, a.body)

    def test_conditions_are_kept(self):
        s = "/v1/sessions/" + self.service.create(OSCILLATOR)["id"]
        etag = self.service.get(s + "/frames/latest").headers["ETag"]
        self.assertEqual(self.service.get(s + "/frames/latest", {"If-Match": etag}).status, 200)
        for tags in ('"x"', "W/" + etag, '"x", "y"'):
            self.assertEqual(self.service.get(s + "/frames/latest", {"If-Match": tags}).status, 412, tags)
            self.assertEqual(self.service.get(s, {"If-Match": tags}).status, 412)
            self.assertEqual(self.service.request("DELETE", s, None, {"If-Match": tags}).status, 412)
            self.assertEqual(self.service.request("POST", s + "/step", {"steps": 1}, {"If-Match": tags}).status, 412)
        now = self.service.get(s, {"If-Match": "*"}).json()
        self.assertEqual(now["step"], 0)
        self.assertEqual(self.service.request("DELETE", s, None, {"If-Match": "*"}).status, 204)

    def test_one_idempotency_key_makes_one(self):
        s = self.service.create(OSCILLATOR)["id"]
        for path, body, ids in (("/v1/sessions/%s/branch" % s, {}, "/v1/sessions"),
                                ("/v1/studies", {"kind": "stability", "scene": OSCILLATOR}, "/v1/operations"),
                                ("/v1/runs", {"scene": OSCILLATOR}, "/v1/operations"),
                                ("/v1/sessions", OSCILLATOR, "/v1/sessions")):
            key = {"Idempotency-Key": str(uuid.uuid4()), "Content-Type": "application/json"}
            first, second = (self.service.request("POST", path, json.dumps(body), key) for _ in range(2))
            self.assertIn(first.status, (201, 202), first.body)
            self.assertEqual((first.status, first.json()["id"], first.headers["Location"]),
                             (second.status, second.json()["id"], second.headers["Location"]), path)
            # The control: another key makes another.
            other = self.service.request("POST", path, json.dumps(body), {**key, "Idempotency-Key": str(uuid.uuid4())})
            self.assertNotEqual(other.json()["id"], first.json()["id"])
            # The same key for something else is refused.
            self.assertEqual(self.service.request("POST", "/v1/sessions/%s/step" % s, {"steps": 1}, {
                "Idempotency-Key": key["Idempotency-Key"]}).json()["code"], "idempotency_key_reused")


class FailedCreate(unittest.TestCase):
    def test_it_leaves_nothing(self):
        """A session whose folder cannot be made is not kept, and one without memory is not made: neither stays listed."""
        with tempfile.TemporaryDirectory() as data:
            service = Service("--max-memory", "60", data=data)
            self.addCleanup(service.stop)
            blocked, refused = str(uuid.uuid4()), str(uuid.uuid4())
            way = pathlib.Path(data) / "sessions" / blocked
            way.mkdir()
            (way / "in the way").write_text("")
            made = service.request("PUT", "/v1/sessions/" + blocked, OSCILLATOR)
            self.assertEqual((made.status, made.json().get("kept", False)), (201, False))
            self.assertEqual(service.request("DELETE", "/v1/sessions/" + blocked).status, 204)
            many = {"systems": [{"type": "particles", "id": "p", "positions": [[0, 0, 0]], "max_particles": 4_000_000}]}
            self.assertGreaterEqual(service.request("PUT", "/v1/sessions/" + refused, many).status, 400)
            self.assertEqual(service.get("/v1/sessions").json()["sessions"], [])
            self.assertFalse([p for p in (pathlib.Path(data) / "sessions").iterdir() if p != way])
            # The id may be used again.
            self.assertEqual(service.request("PUT", "/v1/sessions/" + refused, OSCILLATOR).status, 201)


class Tenants(unittest.TestCase):
    """Two keys: what one does, takes nothing from the other."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        keys = pathlib.Path(cls.folder.name) / "keys"
        keys.write_text("".join("%s %s\n" % (name, name * 8) for name in ("alice", "bob")))
        cls.service = Service("--api-key-file", str(keys))

    @classmethod
    def tearDownClass(cls):
        cls.service.stop()
        cls.folder.cleanup()

    def ask(self, who, method, path, body=None, **headers):
        return self.service.request(method, path, body, {"Authorization": "Bearer " + who * 8, **headers})

    def test_an_asset_is_removed_by_who_put_it(self):
        import hashlib
        text = json.dumps([[1, 2, 3]])
        path = "/v1/assets/" + hashlib.sha256(text.encode()).hexdigest()
        put = lambda who: self.ask(who, "PUT", path, text, **{"Content-Type": "application/json"}).status
        self.assertEqual(put("alice"), 201)
        self.assertEqual(self.ask("bob", "DELETE", path).status, 403)
        self.assertEqual(self.ask("alice", "GET", path).status, 200)
        self.assertEqual(put("bob"), 200)
        # Each ends only its own claim.
        self.assertEqual(self.ask("bob", "DELETE", path).status, 204)
        self.assertEqual(self.ask("alice", "GET", path).status, 200)
        self.assertEqual(self.ask("alice", "DELETE", path).status, 204)
        self.assertEqual(self.ask("alice", "GET", path).status, 404)

    def test_studies_of_one_leave_room_for_others(self):
        run = {"scene": {**OSCILLATOR, "time": {"dt": 1e-6, "duration": 1000}}}
        statuses = [self.ask("bob", "POST", "/v1/runs", run).status for _ in range(40)]
        self.assertIn(429, statuses)
        mine = self.ask("alice", "POST", "/v1/runs", run)
        self.assertEqual(mine.status, 202, mine.body)
        for who in ("alice", "bob"):
            for o in self.ask(who, "GET", "/v1/operations").json()["operations"]:
                self.ask(who, "DELETE", o["links"]["self"])


if __name__ == "__main__":
    unittest.main()
