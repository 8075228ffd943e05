"""What a service must survive: peers that leave, work that takes for ever, signals at bad moments."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

from cases import OSCILLATOR
from harness import BINARY, Service, Socket
from patience import patience

ROPE = {"time": {"dt": 0.004}, "systems": [{"type": "mass_spring", "id": "rope", "stiffness": 2000, "mass": 0.01, "pinned": ["first"],
                                             "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 40}}]}
# Some hundred milliseconds a step.
HEAVY = {"time": {"dt": 0.001}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 1000, "integrator": "rk4",
                                              "cloth_grid": {"nx": 700, "ny": 700}}]}
# One step of seconds: Newton's method and a factorisation at every iteration.
HOUR = {"time": {"dt": 0.05}, "systems": [{"type": "mass_spring", "id": "cloth", "stiffness": 1e5, "integrator": "implicit_euler",
                                            "cloth_grid": {"nx": 220, "ny": 220}}]}


class Lifecycle(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = Service()

    @classmethod
    def tearDownClass(cls):
        cls.service.stop()

    def alive(self):
        self.assertEqual(self.service.get("/healthz").status, 200)
        self.assertIsNone(self.service.process.poll())

    def quick(self, seconds, method, path, body=None):
        start = time.monotonic()
        answer = self.service.request(method, path, body)
        self.assertLess(time.monotonic() - start, patience(seconds), path)
        return answer

    def raw(self, method, path, body=b""):
        """A connection on which a request has been sent and no answer read."""
        peer = socket.create_connection(self.service.address, patience(20))
        head = "%s %s HTTP/1.1\r\nHost: %s\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % (method, path, self.service.host, len(body))
        peer.sendall(head.encode() + body)
        return peer

    def eventually(self, condition, seconds=10):
        end = time.monotonic() + patience(seconds)
        while not condition():
            self.assertLess(time.monotonic(), end, "it did not come to that")
            time.sleep(0.02)

    def test_downloads_that_are_aborted_end_only_their_connection(self):
        s = self.service.create({**ROPE, "recording": {}})
        self.service.post(s["links"]["step"], {"steps": 3000})
        self.service.post(s["links"]["recording"] + "/finish")
        size = int(self.service.request("HEAD", s["links"]["recording"]).headers["Content-Length"])
        self.assertGreater(size, 1 << 20, "the answer must be longer than the socket's buffers")
        for _ in range(10):
            peer = self.raw("GET", s["links"]["recording"])
            peer.recv(100)
            # Closing with bytes unread sends a reset.
            peer.close()
        time.sleep(0.2)
        self.alive()
        self.assertEqual(len(self.service.get(s["links"]["recording"]).body), size)

    def test_endless_seeks_hold_nothing_up(self):
        sessions = [self.service.create(ROPE) for _ in range(4)]
        peers = [self.raw("POST", s["links"]["self"] + "/seek", b'{"step": 1000000000}') for s in sessions]
        time.sleep(0.2)
        for s in sessions:
            self.assertEqual(self.quick(0.5, "GET", s["links"]["self"]).status, 200)
        other = self.quick(1, "POST", "/v1/sessions", OSCILLATOR).json()
        self.assertEqual(self.quick(1, "POST", other["links"]["step"], {"steps": 1}).json()["step"], 1)
        self.assertEqual(self.quick(1, "POST", sessions[0]["links"]["pause"]).status, 200)
        self.assertEqual(self.quick(1, "POST", sessions[1]["links"]["reset"]).json()["step"], 0)
        self.assertEqual(self.quick(1, "DELETE", sessions[2]["links"]["self"]).status, 204)
        peers[3].close()
        answers = [peer.recv(65536) for peer in peers[:3]]
        for answer, status, code in zip(answers, (b"409", b"409", b"404"), (b"interrupted", b"interrupted", b"unknown_session")):
            self.assertIn(b"HTTP/1.1 " + status, answer)
            self.assertIn(code, answer)
        # Whoever asked has left: nothing goes on.
        self.eventually(lambda: self.stands_still(sessions[3]))
        for s in (sessions[0], sessions[1], sessions[3]):
            self.service.request("DELETE", s["links"]["self"])

    def stands_still(self, s):
        first = self.service.get(s["links"]["self"]).json()["step"]
        time.sleep(0.3)
        return self.service.get(s["links"]["self"]).json()["step"] == first

    def test_a_cut_seek_leaves_a_sound_session(self):
        s, whole = self.service.create(ROPE), self.service.create(ROPE)
        peer = self.raw("POST", s["links"]["self"] + "/seek", b'{"step": 1000000000}')
        time.sleep(0.1)
        at = self.service.post(s["links"]["pause"]).json()
        peer.close()
        now = self.service.get(s["links"]["self"]).json()
        self.assertGreaterEqual(now["step"], at["step"])
        self.service.post(whole["links"]["step"], {"steps": now["step"]})
        self.assertEqual(self.service.get(whole["links"]["self"]).json()["state_hash"], now["state_hash"])

    def test_steps_end_with_the_client_that_asked(self):
        s = self.service.create(ROPE)
        peer = self.raw("POST", s["links"]["step"], b'{"steps": 1000000000}')
        time.sleep(0.2)
        peer.close()
        self.eventually(lambda: self.stands_still(s))

    def test_control_of_seeks_on_a_stream(self):
        s = self.service.create(ROPE)
        stream = Socket(self.service, s["links"]["stream"], "truestep.v1.json")
        stream.message("hello")
        stream.send({"control": {"action": "seek", "value": 1e15}})
        time.sleep(0.2)
        self.assertEqual(self.quick(0.5, "GET", s["links"]["self"]).status, 200)
        stream.send({"control": {"action": "seek", "value": 3}})
        self.eventually(lambda: self.service.get(s["links"]["self"]).json()["step"] == 3)
        stream.close()

    def test_a_step_of_seconds_lets_readers_in_and_can_be_ended(self):
        s = self.service.create(HOUR)
        peer = self.raw("POST", s["links"]["step"], b'{"steps": 50}')
        time.sleep(0.3)
        other = self.quick(1, "POST", "/v1/sessions", OSCILLATOR).json()
        for _ in range(10):
            self.assertEqual(self.quick(0.5, "GET", s["links"]["self"]).status, 200)
            self.assertEqual(self.quick(0.5, "POST", other["links"]["step"], {"steps": 1}).status, 200)
        self.assertEqual(self.quick(1, "GET", s["links"]["frames"] + "/latest").status, 200)
        self.assertEqual(self.quick(2, "POST", s["links"]["pause"]).status, 200)
        self.assertIn(b'"interrupted"', peer.recv(65536))
        self.assertEqual(self.quick(2, "DELETE", s["links"]["self"]).status, 204)

    def test_heavy_sessions_do_not_starve_small_ones(self):
        heavy = [self.service.create(HEAVY) for _ in range(2)]
        peers = [self.raw("POST", s["links"]["step"], b'{"steps": 100000}') for s in heavy]
        small = self.service.create(ROPE)

        def stepped():
            return sum(self.service.get(s["links"]["self"]).json()["step"] for s in heavy)

        before = stepped()
        for _ in range(100):
            self.service.post(small["links"]["step"], {"steps": 1})
        # Counted in the others' steps, whatever the machine does beside: whoever waited for them would see two hundred.
        self.assertLess(stepped() - before, 50)
        for peer, s in zip(peers, heavy):
            peer.close()
            self.service.request("DELETE", s["links"]["self"])


class Signals(unittest.TestCase):
    """SIGTERM at every bad moment: exit code 0, streams told, recordings complete."""

    def ends_well(self, service):
        start = time.monotonic()
        service.process.send_signal(signal.SIGTERM)
        self.assertEqual(service.process.wait(patience(20)), 0)
        self.assertLess(time.monotonic() - start, patience(5))

    def test_with_streams_on_playing_sessions_and_steps_in_flight(self):
        for _ in range(8):
            service = Service()
            try:
                sessions = [service.create({**ROPE, "recording": {}}) for _ in range(3)]
                streams = [Socket(service, s["links"]["stream"], "truestep.v1.proto") for s in sessions for _ in range(2)]
                for s in sessions[:2]:
                    service.post(s["links"]["play"], {"speed": 10})
                peers = []
                for path, body in ((sessions[2]["links"]["step"], b'{"steps": 100000000}'), (sessions[1]["links"]["self"] + "/seek", b'{"step": 100000000}')):
                    peer = socket.create_connection(service.address, 20)
                    peer.sendall(("POST %s HTTP/1.1\r\nHost: %s\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % (path, service.host, len(body))).encode() + body)
                    peers.append(peer)
                time.sleep(0.1)
                self.ends_well(service)
                for s in streams:
                    with self.assertRaises(ConnectionError):
                        while True:
                            opcode, payload = s.receive()
                            if opcode == 8:
                                self.assertEqual(payload[:2], (1001).to_bytes(2, "big"))
                                raise ConnectionError
                for p in peers:
                    self.assertIn(b"503", p.recv(65536)[:20])
                for s in sessions:
                    done = subprocess.run([BINARY, "info", os.path.join(service.data, s["id"] + ".vtkhdf"), "--json"], capture_output=True, text=True)
                    self.assertEqual(done.returncode, 0, done.stderr)
            finally:
                service.stop()

    def test_with_a_long_step_and_a_study(self):
        service = Service()
        try:
            s = service.create(HOUR)
            peer = socket.create_connection(service.address, 20)
            body = b'{"steps": 100}'
            peer.sendall(("POST %s HTTP/1.1\r\nHost: %s\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n" % (s["links"]["step"], service.host, len(body))).encode() + body)
            service.post("/v1/studies", {"kind": "stability", "scene": {**ROPE, "time": {"dt": 0.001, "duration": 100}}})
            time.sleep(0.3)
            self.ends_well(service)
        finally:
            service.stop()

    def test_hangup_ends_it_in_order(self):
        service = Service()
        service.process.send_signal(signal.SIGHUP)
        self.assertEqual(service.process.wait(patience(20)), 0)
        service.stop()

    def test_a_log_that_nobody_reads(self):
        with tempfile.TemporaryDirectory() as data:
            process = subprocess.Popen([BINARY, "serve", "--port", "0", "--data-dir", data, "--log-level", "debug"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            line = process.stdout.readline().decode()
            process.stdout.close()
            process.stderr.close()
            address = line.split("http://")[1].strip()
            host, port = address.rsplit(":", 1)
            for _ in range(20):
                with socket.create_connection((host, int(port)), 10) as peer:
                    peer.sendall(("GET /healthz HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n" % address).encode())
                    self.assertIn(b"200", peer.recv(1000))
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(patience(20)), 0)


if __name__ == "__main__":
    unittest.main()
