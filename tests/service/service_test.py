"""The running service as a client sees it: every route of the interface, good and bad input."""
import json
import struct
import subprocess
import time
import unittest

from harness import BINARY, Service, Socket

OSCILLATOR = {"name": "one mass", "time": {"dt": 0.01, "duration": 1},
              "systems": [{"type": "oscillator", "id": "a", "stiffness": 100, "damping": 2, "position": 1}],
              "observables": ["energy"]}


class Case(unittest.TestCase):
    options = ()

    @classmethod
    def setUpClass(cls):
        cls.service = Service(*cls.options)

    @classmethod
    def tearDownClass(cls):
        assert cls.service.stop() == 0


class Sessions(Case):
    def test_create_answers_with_location_and_links(self):
        answer = self.service.post("/v1/sessions", OSCILLATOR)
        self.assertEqual(answer.status, 201)
        session = answer.json()
        self.assertEqual(answer.headers["Location"], session["links"]["self"])
        for link in ("self", "step", "frames", "stream", "picture", "viewer"):
            self.assertIn(link, session["links"])
        self.assertEqual(self.service.get(session["links"]["self"]).json()["step"], 0)

    def test_damped_oscillator_through_http(self):
        # Closed form: exp(-t) (cos(sqrt(99) t) + sin(sqrt(99) t) / sqrt(99)) at t = 1 (reference case ode.damped).
        s = self.service.create({**OSCILLATOR, "time": {"dt": 0.001}})
        step = self.service.post(s["links"]["step"], {"seconds": 1}).json()
        self.assertEqual(step["step"], 1000)
        frame = self.service.get(s["links"]["latest_frame"]).json()
        x = frame["blocks"][0]["values"][0][0]
        self.assertAlmostEqual(x, -0.3368516805904133628, delta=1e-8)  # RK4: error (w dt)^4 / 120 * w = 8e-10
        self.assertEqual(frame["state_hash"], step["state_hash"])

    def test_from_step_is_a_precondition(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.post(s["links"]["step"], {"steps": 5, "from_step": 0}).json()["step"], 5)
        again = self.service.post(s["links"]["step"], {"steps": 5, "from_step": 0})
        self.assertEqual((again.status, again.json()["code"]), (409, "step_conflict"))
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], 5)

    def test_idempotency_key_repeats_the_answer_not_the_step(self):
        s = self.service.create(OSCILLATOR)
        key = {"Idempotency-Key": "one"}
        first = self.service.post(s["links"]["step"], {"steps": 3}, key)
        second = self.service.post(s["links"]["step"], {"steps": 3}, key)
        self.assertEqual(first.body, second.body)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], 3)
        other = self.service.post(s["links"]["step"], {"steps": 4}, key)
        self.assertEqual((other.status, other.json()["code"]), (422, "idempotency_key_reused"))

    def test_create_under_the_clients_own_id(self):
        path = "/v1/sessions/01234567-89ab-4cde-8f01-23456789abcd"
        self.assertEqual(self.service.request("PUT", path, OSCILLATOR).status, 201)
        self.assertEqual(self.service.request("PUT", path, OSCILLATOR).status, 200)
        changed = {**OSCILLATOR, "seed": 8}
        self.assertEqual(self.service.request("PUT", path, changed).status, 409)
        self.assertEqual(self.service.request("PUT", "/v1/sessions/x", OSCILLATOR).status, 400)

    def test_pages_of_sessions(self):
        made = {self.service.create(OSCILLATOR)["id"] for _ in range(5)}
        seen, token = set(), ""
        while True:
            page = self.service.get("/v1/sessions?limit=2&page_token=" + token).json()
            seen |= {s["id"] for s in page["sessions"]}
            token = page.get("next_page_token")
            if not token:
                break
        self.assertTrue(made <= seen)

    def test_deleted_sessions_are_unknown(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.request("DELETE", s["links"]["self"]).status, 204)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["code"], "unknown_session")

    def test_play_pause_reset(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.service.post(s["links"]["play"], {"speed": 4}).json()["status"], "playing")
        deadline = time.monotonic() + 20
        while self.service.get(s["links"]["self"]).json()["step"] < 20 and time.monotonic() < deadline:
            time.sleep(0.02)
        paused = self.service.post(s["links"]["pause"]).json()
        self.assertGreaterEqual(paused["step"], 20)
        time.sleep(0.1)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], paused["step"])
        self.assertEqual(self.service.post(s["links"]["reset"]).json()["step"], 0)

    def test_snapshot_restore_and_branch_continue_the_trajectory(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 30})
        snapshot = self.service.post(s["links"]["snapshots"]).json()
        branch = self.service.post(s["links"]["self"] + "/branch").json()
        a = self.service.post(s["links"]["step"], {"steps": 40}).json()["state_hash"]
        b = self.service.post(branch["links"]["step"], {"steps": 40}).json()["state_hash"]
        self.service.post(s["links"]["snapshots"] + "/" + snapshot["id"] + "/restore")
        c = self.service.post(s["links"]["step"], {"steps": 40}).json()["state_hash"]
        self.assertEqual([a, a], [b, c])

    def test_seek_is_exact(self):
        s = self.service.create(OSCILLATOR)
        at_20 = self.service.post(s["links"]["step"], {"steps": 20}).json()["state_hash"]
        self.service.post(s["links"]["step"], {"steps": 80})
        back = self.service.post(s["links"]["self"] + "/seek", {"step": 20}).json()
        self.assertEqual((back["step"], back["state_hash"]), (20, at_20))

    def test_instability_says_where_and_what_would_have_held(self):
        s = self.service.create({"time": {"dt": 1}, "systems": [{"type": "oscillator", "id": "a", "stiffness": 1e6, "position": 1, "integrator": "symplectic_euler"}]})
        answer = self.service.post(s["links"]["step"], {"steps": 5000})
        self.assertEqual(answer.status, 409)
        problem = answer.json()
        self.assertEqual(problem["code"], "instability")
        self.assertEqual(problem["system"], "a")
        # omega = 1000 rad/s: symplectic Euler holds for dt <= 2 / omega.
        self.assertAlmostEqual(problem["suggested_dt"], 2e-3, delta=1e-9)
        self.assertEqual(self.service.get(s["links"]["self"]).json()["step"], problem["last_good_step"])


class Output(Case):
    def test_poll_and_long_poll(self):
        s = self.service.create(OSCILLATOR)
        frames = s["links"]["frames"]
        self.assertEqual(self.service.get(frames).json()["last_step"], 0)
        self.assertEqual(self.service.get(frames + "?after=0").status, 204)
        self.service.post(s["links"]["step"], {"steps": 10})
        page = self.service.get(frames + "?after=0&limit=100").json()
        self.assertEqual([f["step"] for f in page["frames"]], list(range(1, 11)))
        start = time.monotonic()
        self.assertEqual(self.service.get(frames + "?after=10&wait=0.3").status, 204)
        self.assertGreaterEqual(time.monotonic() - start, 0.3)
        self.service.post(s["links"]["play"])
        self.assertGreater(self.service.get(frames + "?after=10&wait=20").json()["last_step"], 10)

    def test_frames_nobody_asked_for_are_not_built(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 100})
        self.assertEqual(self.service.get(s["links"]["self"]).json()["frames_built"], 0)

    def test_protobuf_frame(self):
        s = self.service.create(OSCILLATOR)
        answer = self.service.get(s["links"]["latest_frame"], {"Accept": "application/x-protobuf"})
        self.assertEqual(answer.headers["Content-Type"], "application/x-protobuf")
        # The position 1 as little-endian float lies in the block's bytes.
        self.assertIn(struct.pack("<f", 1.0), answer.body)

    def test_earlier_frames_are_exact(self):
        s = self.service.create(OSCILLATOR)
        hashes = [self.service.post(s["links"]["step"], {"steps": 1}).json()["state_hash"] for _ in range(5)]
        for step, value in enumerate(hashes, 1):
            self.assertEqual(self.service.get(s["links"]["frames"] + "/%d" % step).json()["state_hash"], value)
        self.assertEqual(self.service.get(s["links"]["frames"] + "/6").status, 404)

    def test_observables_as_json_and_csv(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 50})
        o = self.service.get(s["links"]["observables"] + "?names=energy.total").json()
        self.assertEqual(len(o["series"]["step"]), 51)
        energy = o["series"]["values"]["energy.total"]
        self.assertAlmostEqual(energy[0], 50, delta=1e-12)  # k x^2 / 2
        self.assertLess(energy[-1], energy[0])
        csv = self.service.get(s["links"]["observables"] + "?names=energy.total&max_points=10", {"Accept": "text/csv"}).body.decode().splitlines()
        self.assertEqual(csv[0], "step,time,energy.total")
        self.assertLessEqual(len(csv) - 1, 10)

    def test_plan_names_passes_and_what_was_skipped(self):
        s = self.service.create(OSCILLATOR)
        self.service.post(s["links"]["step"], {"steps": 10})
        passes = self.service.get(s["links"]["plan"]).json()["passes"]
        self.assertTrue(any(p["pass"] == "integrate" and p["runs"] and p["share"] > 0 for p in passes))
        self.assertTrue(all(p["reason"] for p in passes))

    def test_picture_is_a_png_of_the_wanted_size(self):
        s = self.service.create(OSCILLATOR)
        answer = self.service.get(s["links"]["picture"] + "?width=320&height=200")
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "image/png"))
        self.assertEqual(answer.body[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", answer.body[16:24]), (320, 200))
        self.assertEqual(self.service.get(s["links"]["picture"] + "?width=8").status, 400)
        self.assertEqual(self.service.get(s["links"]["picture"] + "?camera=1,2").status, 400)

    def test_recording_is_refused_while_written_and_served_afterwards(self):
        s = self.service.create({**OSCILLATOR, "recording": {"every": 2}})
        self.service.post(s["links"]["step"], {"steps": 10})
        busy = self.service.get(s["links"]["recording"])
        self.assertEqual(busy.status, 409)
        done = self.service.post(busy.json()["finish"]).json()
        self.assertEqual(done["frames"], 6)  # steps 0, 2 ... 10
        answer = self.service.get(done["recording"])
        self.assertEqual(answer.body[:8], b"\x89HDF\r\n\x1a\n")
        part = self.service.get(done["recording"], {"Range": "bytes=0-7"})
        self.assertEqual((part.status, part.body), (206, answer.body[:8]))
        self.assertEqual(self.service.get(done["recording"], {"If-None-Match": answer.headers["ETag"]}).status, 304)

    def test_recording_ends_by_itself_at_the_scenes_duration(self):
        s = self.service.create({**OSCILLATOR, "recording": {}})
        self.service.post(s["links"]["step"], {"seconds": 1})
        self.assertEqual(self.service.get(s["links"]["recording"]).status, 200)


class Catalogue(Case):
    def test_every_system_is_described(self):
        systems = self.service.get("/v1/systems").json()["systems"]
        self.assertGreaterEqual(len(systems), 4)
        for s in systems:
            d = self.service.get("/v1/systems/" + s["type"]).json()
            self.assertTrue(d["parameters"] and d["guarantees"])

    def test_every_gallery_scene_is_valid_and_says_what_it_teaches(self):
        scenes = self.service.get("/v1/gallery").json()["scenes"]
        self.assertGreaterEqual(len(scenes), 10)
        for entry in scenes:
            scene = self.service.get("/v1/gallery/" + entry["name"]).json()
            self.assertTrue(scene["teaches"] and scene["expect"], entry["name"])
            self.assertTrue(all(e.get("source") for e in scene["expect"]), entry["name"])
            report = self.service.post("/v1/scenes/validate", scene["scene"])
            self.assertEqual((report.status, report.json()["errors"]), (200, []), entry["name"])

    def test_all_faults_of_a_scene_at_once(self):
        bad = {"time": {"dt": -1}, "gravty": [0, 0, 0], "systems": [{"type": "oscilator"}, {"type": "oscillator", "mass": "5 cm", "stiffness": "1 kN/m"}]}
        answer = self.service.post("/v1/sessions", bad)
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (422, "application/problem+json"))
        errors = {e["pointer"]: e for e in answer.json()["errors"]}
        self.assertEqual(set(errors), {"/time/dt", "/gravty", "/systems/0/type", "/systems/1/mass"})
        self.assertEqual(errors["/gravty"]["did_you_mean"], "gravity")
        self.assertEqual(errors["/systems/0/type"]["did_you_mean"], "oscillator")
        self.assertEqual(errors["/systems/1/mass"]["unit"], "kg")

    def test_units_are_echoed_in_si(self):
        scene = {"systems": [{"type": "oscillator", "id": "a", "mass": "250 g", "stiffness": "1 kN/m", "position": "5 cm"}]}
        echoed = self.service.post("/v1/scenes/validate", scene).json()["scene"]["systems"][0]
        self.assertEqual((echoed["mass"], echoed["stiffness"], echoed["position"]), (0.25, 1000.0, 0.05))

    def test_descriptions(self):
        api = self.service.get("/openapi.json").json()
        self.assertEqual(api["openapi"], "3.1.0")
        for path in ("/v1/sessions", "/v1/sessions/{id}/step", "/v1/sessions/{id}/stream", "/v1/gallery"):
            self.assertIn(path, api["paths"])
        schema = self.service.get("/v1/schemas/scene-1.json").json()
        self.assertEqual(schema["$schema"], "https://json-schema.org/draft/2020-12/schema")
        self.assertIn(b"/v1/sessions", self.service.get("/docs").body)
        self.assertIn(b"<html", self.service.get("/").body.lower())

    def test_health_and_metrics(self):
        self.assertEqual(self.service.get("/healthz").status, 200)
        self.assertEqual(self.service.get("/readyz").status, 200)
        self.assertIn("version", self.service.get("/version").json())
        self.assertIn(b"truestep_sessions ", self.service.get("/metrics").body)
        self.assertEqual(subprocess.run([BINARY, "health", self.service.url], capture_output=True).returncode, 0)

    def test_bad_requests(self):
        s = self.service.create(OSCILLATOR)
        for path, body, status in (("/step", {"steps": -1}, 400), ("/step", {"stepz": 1}, 400), ("/step", {"steps": 1, "seconds": 1}, 400),
                                   ("/play", {"speed": 0}, 400), ("/seek", {}, 400), ("/commands", {"type": "kick"}, 422),
                                   ("/commands", {"type": "impulse", "system": "a", "index": 7, "impulse": [0, 0, 0]}, 422),
                                   ("/commands", {"type": "impulse", "system": "b", "index": 0, "impulse": [0, 0, 0]}, 422)):
            answer = self.service.post(s["links"]["self"] + path, body)
            self.assertEqual(answer.status, status, (path, body, answer.body))
            self.assertEqual(answer.headers["Content-Type"], "application/problem+json")
        self.assertEqual(self.service.request("POST", "/v1/sessions", "x", {"Content-Type": "text/plain"}).status, 415)
        self.assertEqual(self.service.request("PATCH", "/v1/sessions").status, 405)
        self.assertEqual(self.service.get("/nothing").status, 404)


class Stream(Case):
    def socket(self, *arguments):
        ws = Socket(self.service, *arguments)
        self.addCleanup(ws.close)
        return ws

    def open(self, scene=OSCILLATOR):
        self.session = self.service.create(scene)
        return self.socket(self.session["links"]["stream"], "truestep.v1.json")

    def test_hello_topology_playback_frame(self):
        ws = self.open()
        self.assertEqual(ws.status, 101)
        hello = ws.message("hello")
        self.assertEqual((hello["session"], hello["systems"][0]["id"]), (self.session["id"], "a"))
        self.assertEqual(ws.message("topology")["systems"][0]["system"], "a")
        self.assertFalse(ws.message("playback")["playing"])
        self.assertEqual(ws.message("frame")["step"], "0")

    def test_credit_bounds_the_frames_in_flight_and_gaps_are_counted(self):
        ws = self.open()
        ws.send({"request_id": "s", "subscribe": {"credit": 2, "encoding": "F64"}})
        ws.message("reply")
        self.service.post(self.session["links"]["step"], {"steps": 50})
        time.sleep(0.2)
        ws.send({"credit": {"frames": 1}})
        last = ws.message("frame")
        while int(last["step"]) < 50:
            last = ws.message("frame")
        # One frame answered the subscription, one step used the second credit, the new credit brought the newest.
        self.assertGreaterEqual(int(last["dropped"]), 48)
        self.assertEqual(last["state_hash"], str(int(self.service.get(self.session["links"]["self"]).json()["state_hash"], 16)))

    def test_every_policy_leaves_no_gap(self):
        ws = self.open()
        ws.send({"request_id": "s", "subscribe": {"policy": "EVERY"}})
        ws.message("reply")
        self.service.post(self.session["links"]["step"], {"steps": 300})
        self.assertEqual([int(ws.message("frame")["step"]) for _ in range(300)], list(range(1, 301)))

    def test_commands_and_control_over_the_stream(self):
        ws = self.open()
        ws.send({"request_id": "c", "command": {"json": json.dumps({"type": "impulse", "system": "a", "index": 0, "impulse": [1, 0, 0]})}})
        self.assertEqual(ws.message("reply")["request_id"], "c")
        ws.send({"request_id": "x", "command": {"json": "{}"}})
        self.assertEqual(ws.message("problem")["code"], "bad_command")
        ws.send({"request_id": "p", "control": {"action": "play", "value": 2}})
        while not ws.message("playback")["playing"]:
            pass
        ws.send({"request_id": "q", "control": {"action": "pause"}})
        while ws.message("playback")["playing"]:
            pass

    def test_unknown_subprotocols_and_foreign_origins_are_refused(self):
        s = self.service.create(OSCILLATOR)
        self.assertEqual(self.socket(s["links"]["stream"], "chat").status, 400)
        self.assertEqual(self.socket(s["links"]["stream"], None, ["Origin: http://evil.example"]).status, 403)
        self.assertEqual(self.socket("/v1/sessions/nobody/stream").status, 404)


class Ending(unittest.TestCase):
    def test_sigterm_closes_streams_and_finishes_recordings(self):
        service = Service()
        try:
            s = service.create({**OSCILLATOR, "recording": {}})
            ws = Socket(service, s["links"]["stream"], "truestep.v1.json")
            self.addCleanup(ws.close)
            service.post(s["links"]["play"])
            ws.message("frame")
            service.process.terminate()
            try:
                while True:
                    opcode, payload = ws.receive()
                    if opcode == 8:
                        break
            except ConnectionError:
                self.fail("no close frame")
            self.assertEqual(struct.unpack(">H", payload[:2])[0], 1001)
            ws._frame(8, payload[:2])
            self.assertEqual(service.process.wait(5), 0)
            info = subprocess.run([BINARY, "info", "--json", "%s/%s.vtkhdf" % (service.data, s["id"])], capture_output=True, text=True)
            self.assertEqual(info.returncode, 0, info.stderr)
            self.assertTrue(json.loads(info.stdout)["finalized"])
        finally:
            service.stop()

    def test_limits_are_answered_with_the_estimate(self):
        service = Service("--max-sessions", "2")
        try:
            service.create(OSCILLATOR)
            service.create(OSCILLATOR)
            refused = service.post("/v1/sessions", OSCILLATOR)
            self.assertEqual((refused.status, refused.json()["code"]), (429, "quota_exceeded"))
            self.assertIsNotNone(refused.headers["Retry-After"])
        finally:
            self.assertEqual(service.stop(), 0)

    def test_other_machines_need_a_key(self):
        refused = subprocess.run([BINARY, "serve", "--host", "0.0.0.0", "--port", "0"], capture_output=True, text=True, timeout=20)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--api-key-file", refused.stderr)


class CommandLine(unittest.TestCase):
    def run_truestep(self, *arguments, text=None):
        return subprocess.run([BINARY, *arguments], input=text, capture_output=True, text=True, timeout=120)

    def test_exit_codes(self):
        good = json.dumps(OSCILLATOR)
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5", text=good).returncode, 0)
        self.assertEqual(self.run_truestep("run").returncode, 2)
        self.assertEqual(self.run_truestep("run", "-", text="{}").returncode, 3)
        unstable = {"time": {"dt": 1}, "systems": [{"type": "oscillator", "stiffness": 1e6, "position": 1, "integrator": "euler"}]}
        self.assertEqual(self.run_truestep("run", "-", "--steps", "5000", text=json.dumps(unstable)).returncode, 4)
        missed = {**OSCILLATOR, "expect": [{"quantity": "energy.total", "min": 1e9, "source": "a control"}]}
        self.assertEqual(self.run_truestep("run", "-", text=json.dumps(missed)).returncode, 6)

    def test_run_prints_one_json_object(self):
        done = self.run_truestep("run", "-", "--steps", "100", "--json", "--progress", "none", text=json.dumps(OSCILLATOR))
        result = json.loads(done.stdout)
        for key in ("steps", "time", "wall_seconds", "state_hash", "observables", "expect"):
            self.assertIn(key, result)
        again = json.loads(self.run_truestep("run", "-", "--steps", "100", "--json", "--threads", "3", text=json.dumps(OSCILLATOR)).stdout)
        self.assertEqual(result["state_hash"], again["state_hash"])

    def test_validate_lists_faults(self):
        done = self.run_truestep("validate", "-", text='{"systems": [{"type": "oscillator", "mas": 1}]}')
        self.assertEqual(done.returncode, 3)
        self.assertIn("/systems/0/mas", done.stdout)
        self.assertIn('did you mean "mass"', done.stdout)


if __name__ == "__main__":
    unittest.main()
