#!/usr/bin/env python3
"""GET of a small cached body: our HTTP layer beside a bare Beast server, both under wrk (Debian package wrk) with 32
connections, on the same cores in turns: short rounds alternate and each side's best counts, because other load can
only slow a round down. Requests per second of the server's own processor time are compared too (medians; other load
hardly moves them), and 16 requests pipelined on each connection."""
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

BUILD = os.environ.get("TRUESTEP_BUILD", "build/release")
ROUNDS, SECONDS, CONNECTIONS = 8, 1, 32
PIPELINE = 'init = function() local r = {} for i = 1, 16 do r[i] = wrk.format("GET") end all = table.concat(r) end\nrequest = function() return all end\n'


def start(command):
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    return server, server.stdout.readline().split("listening on ", 1)[1].strip()


def cpu_seconds(pid):
    with open("/proc/%d/stat" % pid) as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(server, url, script):
    """(requests per second, requests per second of processor time) of one round."""
    command = ["wrk", "-t1", "-c%d" % CONNECTIONS, "-d%ds" % SECONDS] + (["-s", script] if script else []) + [url]
    before = cpu_seconds(server.pid)
    out = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    used = max(cpu_seconds(server.pid) - before, 0.01)
    if "Non-2xx" in out or "Socket errors" in out:
        sys.exit("wrk saw errors:\n" + out)
    return float(re.search(r"Requests/sec:\s+([\d.]+)", out).group(1)), int(re.search(r"(\d+) requests in", out).group(1)) / used


def report(metric, mine, theirs):
    print(json.dumps({"bench": "http_layer", "metric": metric, "ours": mine, "peer": theirs, "peer_name": "Beast 1.81 hello",
                      "ratio": mine / theirs, "error_ours": None, "error_peer": None, "threads": 1}), flush=True)


def main():
    if not shutil.which("wrk"):
        sys.exit("wrk is missing: apt-get install wrk")
    ours, our_url = start([BUILD + "/bin/net_echo"])
    peer, peer_url = start([BUILD + "/bin/beast_hello"])
    try:
        with tempfile.NamedTemporaryFile("w", suffix=".lua") as script:
            script.write(PIPELINE)
            script.flush()
            for what, lua in (("GET of 512 bytes", None), ("16 pipelined", script.name)):
                rounds = [(measure(ours, our_url + "/frame", lua), measure(peer, peer_url + "/", lua)) for _ in range(ROUNDS)]
                report("requests/s, " + what, *(max(r[side][0] for r in rounds) for side in (0, 1)))
                report("requests per CPU second, " + what, *(statistics.median(r[side][1] for r in rounds) for side in (0, 1)))
    finally:
        for server in (ours, peer):
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
