"""What a careful client asks of HTTP and the stream: a final answer instead of 100 where it is known, a bound on the head, a policy
for the content of pages, and refusals of controls that mean nothing."""
import os
import pathlib
import socket
import tempfile
import unittest
from unittest import mock

from cases import OSCILLATOR, Case
from harness import BINARY, Service, Socket
from patience import patience


class Manners(Case):
    def raw(self, text, body=b""):
        """The first bytes that come back for a head."""
        with socket.create_connection(self.service.address, patience(20)) as s:
            s.sendall(text.replace("HOST", self.service.host).encode())
            first = s.recv(4096)
            if body and first.startswith(b"HTTP/1.1 100"):
                s.sendall(body)
                first += s.recv(4096)
            return first.decode("latin1")

    def test_a_known_answer_instead_of_100(self):
        s = self.service.create(OSCILLATOR)["id"]
        head = "%s %s HTTP/1.1\r\nHost: HOST\r\nContent-Type: application/json\r\nContent-Length: %d\r\nExpect: 100-continue\r\n%s\r\n"
        step = "/v1/sessions/%s/step" % s
        for method, path, length, more, status in (("POST", "/v1/nowhere", 2, "", 404), ("PUT", "/healthz", 2, "", 405),
                                                   ("POST", "/v1/sessions", 1 << 40, "", 413), ("POST", step + "?x=1", 2, "", 400),
                                                   ("POST", step, 2, 'If-Match: "x"\r\n', 412)):
            answer = self.raw(head % (method, path, length, more))
            self.assertTrue(answer.startswith("HTTP/1.1 %d " % status), (path, answer[:60]))
        # What depends on the body is asked for: the control.
        answer = self.raw(head % ("POST", step, 2, ""), b"{}")
        self.assertTrue(answer.startswith("HTTP/1.1 100 "), answer[:60])
        self.assertIn("HTTP/1.1 200 ", answer)

    def test_a_head_is_bounded_however_it_is_divided(self):
        for count, size in ((10, 2000), (20, 1000), (90, 200), (1, 17000), (2000, 8)):
            head = "GET /healthz HTTP/1.1\r\nHost: HOST\r\n" + "".join("h%d: %s\r\n" % (k, "v" * size) for k in range(count)) + "\r\n"
            self.assertTrue(self.raw(head).startswith("HTTP/1.1 431 "), (count, size))
        head = "GET /healthz HTTP/1.1\r\nHost: HOST\r\n" + "".join("h%d: %s\r\n" % (k, "v" * 1500) for k in range(10)) + "\r\n"
        self.assertTrue(self.raw(head).startswith("HTTP/1.1 200 "))

    def test_the_page_of_the_api_has_a_policy(self):
        page = self.service.get("/docs")
        policy = page.headers["Content-Security-Policy"]
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn(b"<script", page.body)
        self.assertIn(b"<style", page.body)
        self.assertIn("style-src 'unsafe-inline'", policy)

    def test_controls_that_mean_nothing(self):
        s = self.service.create(OSCILLATOR)["id"]
        stream = Socket(self.service, "/v1/sessions/%s/stream" % s, "truestep.v1.json")
        for k, message in enumerate(({"control": {"action": "speed", "value": 0}}, {"control": {"action": "speed", "value": -1}},
                                     {"control": {"action": "play", "value": -1}}, {"control": {"action": "speed", "value": "Infinity"}},
                                     {"control": {"action": "speed", "value": "NaN"}}, {"control": {"action": "step", "value": "NaN"}},
                                     {"subscribe": {"policy": 99}})):
            stream.send({"requestId": str(k), **message})
            self.assertEqual(stream.message("problem")["request_id"], str(k), message)
        for k, message in enumerate(({"control": {"action": "speed", "value": 2}}, {"control": {"action": "play"}},
                                     {"control": {"action": "pause"}}, {"subscribe": {"policy": 1}})):
            stream.send({"requestId": "good%d" % k, **message})
            self.assertEqual(stream.message("reply")["request_id"], "good%d" % k)
        stream.close()


class FullMachine(unittest.TestCase):
    def test_what_the_machine_refuses_is_refused(self):
        """Under a limit of address space below the budget: 503 or 429, nothing of it stays, and the service goes on."""
        if os.environ.get("TRUESTEP_SANITIZE"):
            return  # their shadow memory alone is more
        with tempfile.TemporaryDirectory() as data:
            script = pathlib.Path(data) / "limited"
            script.write_text("#!/bin/bash\nulimit -v 1200000\nexec %s \"$@\"\n" % BINARY)
            script.chmod(0o755)
            with mock.patch("harness.BINARY", str(script)):
                service = Service("--threads", "2", data=data + "/data")
            self.addCleanup(service.stop)
            cloth = {"systems": [{"type": "mass_spring", "id": "c", "stiffness": 100, "mass": 0.01, "cloth_grid": {"nx": 380, "ny": 380}}]}
            answers = [service.made(cloth) for _ in range(12)]
            self.assertEqual(answers[0].status in (200, 201), True, answers[0].body)
            refused = [a for a in answers if a.status not in (200, 201)]
            self.assertTrue(refused, "the control: there is not room for all")
            self.assertLessEqual({a.status for a in refused}, {429, 503}, refused[0].body)
            listed = service.get("/v1/sessions").json()["sessions"]
            self.assertEqual(len(listed), len(answers) - len(refused))
            for s in listed:
                self.assertEqual(service.request("DELETE", s["links"]["self"]).status, 204)
            self.assertEqual(service.made(OSCILLATOR).status, 201)


if __name__ == "__main__":
    unittest.main()
