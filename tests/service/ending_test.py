"""The end of the service, and its limits."""
import json
import struct
import subprocess
import unittest

from cases import OSCILLATOR
from harness import BINARY, Service, Socket
from patience import patience


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
        refused = subprocess.run([BINARY, "serve", "--host", "0.0.0.0", "--port", "0"], capture_output=True, text=True, timeout=patience(20))
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--api-key-file", refused.stderr)


if __name__ == "__main__":
    unittest.main()
