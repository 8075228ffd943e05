"""A running `truestep serve` and small clients for it (HTTP and WebSocket, standard library only)."""
import base64
import http.client
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

from patience import patience

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BINARY = os.environ.get("TRUESTEP_BINARY", str(SOURCE / "build" / "release" / "bin" / "truestep"))


class Answer:
    def __init__(self, response, body):
        self.status, self.headers, self.body = response.status, response.headers, body

    def json(self):
        return json.loads(self.body)


class Service:
    """Starts the server on a free port with a data directory of its own, or with `data`; ends it with SIGTERM."""

    def __init__(self, *options, data=None):
        self.data = data or tempfile.mkdtemp(prefix="truestep")
        self.process = subprocess.Popen([BINARY, "serve", "--port", "0", "--data-dir", self.data, "--log-level", "warn", *options],
                                        stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        # What it warns of at its start comes first.
        while " [warning] " in line:
            line = self.process.stdout.readline()
        assert "listening on " in line, line
        self.url = line.split("listening on ")[1].strip()
        self.host = self.url.split("//")[1]
        self.address = (self.host.rsplit(":", 1)[0], int(self.host.rsplit(":", 1)[1]))
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def request(self, method, path, body=None, headers=None):
        connection = http.client.HTTPConnection(*self.address, timeout=patience(60))
        headers = dict(headers or {})
        if body is not None and not isinstance(body, (bytes, str)):
            body = json.dumps(body)
            headers.setdefault("Content-Type", "application/json")
        connection.request(method, path, body, headers)
        response = connection.getresponse()
        answer = Answer(response, response.read())
        connection.close()
        return answer

    def get(self, path, headers=None):
        return self.request("GET", path, None, headers)

    def post(self, path, body=None, headers=None):
        return self.request("POST", path, {} if body is None else body, headers)

    def made(self, scene):
        """The answer to a scene, whether it was there at once or not."""
        answer = self.post("/v1/sessions", scene)
        # What takes longer to make than a request waits is made meanwhile.
        end = time.monotonic() + patience(60)
        while answer.status == 202 and time.monotonic() < end:
            time.sleep(0.05)
            now = self.get(answer.json()["links"]["self"])
            if now.json().get("status") != "creating":
                answer = now
        return answer

    def create(self, scene):
        answer = self.made(scene)
        assert answer.status in (200, 201), answer.body
        return answer.json()

    def stop(self):
        """The exit code after SIGTERM."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            code = self.process.wait(15)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = "killed"
        self.process.stdout.close()
        shutil.rmtree(self.data, ignore_errors=True)
        return code


class Socket:
    """A WebSocket client: text and binary messages, pings answered."""

    def __init__(self, service, path, protocol=None, headers=()):
        self.socket = socket.create_connection(service.address, 20)
        lines = ["GET %s HTTP/1.1" % path, "Host: " + service.host, "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode()]
        if protocol:
            lines.append("Sec-WebSocket-Protocol: " + protocol)
        self.socket.sendall(("\r\n".join([*lines, *headers]) + "\r\n\r\n").encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            part = self.socket.recv(65536)
            if not part:
                break
            self.buffer += part
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.head = head.decode("latin1")
        self.status = int(self.head.split(" ")[1])

    def _take(self, count):
        while len(self.buffer) < count:
            part = self.socket.recv(1 << 20)
            if not part:
                raise ConnectionError("closed")
            self.buffer += part
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def _frame(self, opcode, data):
        mask = os.urandom(4)
        n = len(data)
        head = bytes([0x80 | opcode])
        head += bytes([0x80 | n]) if n < 126 else bytes([0xFE]) + struct.pack(">H", n) if n < 65536 else bytes([0xFF]) + struct.pack(">Q", n)
        self.socket.sendall(head + mask + bytes(b ^ mask[i & 3] for i, b in enumerate(data)))

    def send(self, message):
        self._frame(1, json.dumps(message).encode())

    def receive(self):
        """(opcode, payload) of the next message; pings are answered."""
        while True:
            first, second = self._take(2)
            size = second & 127
            if size == 126:
                size = struct.unpack(">H", self._take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self._take(8))[0]
            payload = self._take(size)
            if first & 15 == 9:
                self._frame(10, payload)
            else:
                return first & 15, payload

    def message(self, kind):
        """The next JSON message of this kind."""
        while True:
            opcode, payload = self.receive()
            if opcode == 8:
                raise ConnectionError("closed with %d" % struct.unpack(">H", payload[:2]))
            message = json.loads(payload)
            if kind in message:
                return message[kind]

    def close(self):
        self.socket.close()
