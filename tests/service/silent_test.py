"""Clients of a stream that never read are cut off once nothing could be written to them for 30 s, however many they are, and one that
reads is not. SILENT_CLIENTS (default 200) says how many."""
import os
import threading
import time
import unittest

from harness import Service, Socket
from patience import patience

CLIENTS = int(os.environ.get("SILENT_CLIENTS", "200"))
STALL = 30  # s: server/net/websocket/websocket.h
# 3,000 positions a frame: what the sockets hold is full after some seconds.
SCENE = {"time": {"dt": 0.0333, "duration": 1000}, "keep_running": True,
         "systems": [{"type": "particles", "id": "p", "fill": [{"count": 3000, "center": [0, 5, 0], "half_extents": [1, 1, 1]}]}]}


class Silent(unittest.TestCase):
    def test_they_are_cut_off_and_a_reader_is_not(self):
        service = Service()
        self.addCleanup(service.stop)
        descriptors = lambda: len(os.listdir("/proc/%d/fd" % service.process.pid))
        session = service.create(SCENE)
        before = descriptors()
        reader = Socket(service, session["links"]["stream"], "truestep.v1.json")
        read = []

        def keep_reading():
            # Frames, not bytes: a reader that leaves pings without an answer is cut off too, after 41 s.
            try:
                while reader.receive()[0] != 8:
                    read.append(time.monotonic())
            except OSError:
                pass

        threading.Thread(target=keep_reading, daemon=True).start()
        silent = [Socket(service, session["links"]["stream"], "truestep.v1.json") for _ in range(CLIENTS)]
        self.assertEqual({s.status for s in silent}, {101})
        self.assertEqual(service.post(session["links"]["self"] + "/play").status, 200)
        time.sleep(5)
        self.assertGreaterEqual(descriptors() - before, CLIENTS, "the control: they are there before the limit")
        # Until the sockets are full, then the limit.
        end = time.monotonic() + STALL + patience(60)
        while descriptors() - before > 20 and time.monotonic() < end:
            time.sleep(1)
        self.assertLessEqual(descriptors() - before, 20)
        cut = time.monotonic()
        end = cut + patience(10)
        while (not read or read[-1] < cut) and time.monotonic() < end:
            time.sleep(0.1)
        self.assertGreater(read[-1], cut, "the reader is still served")
        for client in [reader, *silent]:
            client.close()


if __name__ == "__main__":
    unittest.main()
