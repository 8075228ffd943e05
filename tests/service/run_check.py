#!/usr/bin/env python3
"""Runs one check script against a freshly started server.

usage: run_check.py --script FILE --server 'COMMAND ...' [--arg ...] [--expect TEXT]

COMMAND must print a line 'listening on URL' on stdout. In the arguments after '--', {url}, {ws} and {pid} stand for
the server's address, its ws:// form and its process id.
--play NAME: creates a session from the gallery's scene NAME and plays it; {stream} is the ws:// address of its stream.
--expect TEXT: some line of the script's output must contain TEXT (the full score). The server must survive the
check and end with exit 0 on SIGTERM.
"""
import argparse
import json
import shlex
import signal
import subprocess
import sys
import threading
import urllib.request

from patience import patience

def start(command):
    """Starts the server and waits for its address."""
    server = subprocess.Popen(shlex.split(command), stdout=subprocess.PIPE, text=True)
    killer = threading.Timer(patience(30), server.kill)
    killer.start()
    for line in server.stdout:
        if "listening on " in line:
            killer.cancel()
            # Keep the pipe empty so that the server never blocks on it.
            threading.Thread(target=server.stdout.read, daemon=True).start()
            return server, line.split("listening on ", 1)[1].split()[0]
    killer.cancel()
    sys.exit("the server ended before it listened: %s" % command)


def play(url, name):
    """The path of the stream of a new session that plays a gallery scene."""
    def post(path, body):
        request = urllib.request.Request(url + path, json.dumps(body).encode(), {"Content-Type": "application/json"})
        return json.load(urllib.request.urlopen(request, timeout=patience(30)))

    links = post("/v1/sessions", {"gallery": name})["links"]
    post(links["play"], {})
    return links["stream"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--script", required=True)
    parser.add_argument("--server", required=True)
    parser.add_argument("--expect", default="")
    parser.add_argument("--play", default="")
    parser.add_argument("rest", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    server, url = start(options.server)
    try:
        values = {"url": url, "ws": url.replace("http", "ws", 1), "pid": server.pid}
        if options.play:
            values["stream"] = values["ws"] + play(url, options.play)
        named = ["{%s}" % name for name in values]
        arguments = [a.format(**values) if any(n in a for n in named) else a for a in options.rest if a != "--"]
        done = subprocess.run([sys.executable, options.script, *arguments], stdout=subprocess.PIPE, text=True)
        print(done.stdout, end="")
        if done.returncode:
            return done.returncode
        if options.expect not in done.stdout:
            print("expected: %s" % options.expect)
            return 1
        if server.poll() is not None:
            print("the server died with %d" % server.returncode)
            return 1
        server.send_signal(signal.SIGTERM)
        if server.wait(patience(10)) != 0:
            print("the server's exit code was %d" % server.returncode)
            return 1
        return 0
    finally:
        if server.poll() is None:
            server.kill()
            server.wait()


if __name__ == "__main__":
    sys.exit(main())
