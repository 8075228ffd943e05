"""Who may include whom: a file includes its own layer and the layers above it, never below.

The order is DESIGN's section 3. Besides the order: include paths start at the root, one system never includes
another, the engine knows no HTTP and no socket, GL stays inside the picture sink, the server holds no physics,
Boost.Asio and Beast stay inside server/net, CLI11 inside one file.
"""
import re

from source import Finding

LAYERS = ["base", "math", "geometry", "kernels", "neighbours", "core", "integrators", "collision", "lattice", "rigid", "animation", "systems", "couplings", "reference",
          "scene", "session", "studies", "sinks"]
PHYSICS = {"math", "geometry", "kernels", "neighbours", "integrators", "collision", "lattice", "rigid", "animation", "systems", "couplings", "reference"}
NET = re.compile(r"^boost/(asio|beast)[./]")
NETWORK = re.compile(r"^(boost/(asio|beast)|sys/socket|sys/epoll|netinet/|arpa/|netdb\.h|poll\.h|curl/|prometheus/|CLI/)")
GL = re.compile(r"^(GL|GLES[23]?|EGL|KHR)/")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def includes(lines):
    """(line number, "<" or the quote, path) of every include."""
    for number, line in enumerate(lines, 1):
        if match := INCLUDE.match(line):
            yield number, match[1], match[2]


def layer_of(path):
    """The layer's name of an engine path, None for files that lie in no layer (pch.h)."""
    parts = path.split("/")
    return parts[1] if parts[0] == "engine" and len(parts) > 2 else None


def check(tree):
    for path, lines in tree.code("engine", "server"):
        if layer_of(path) is not None and layer_of(path) not in LAYERS:
            yield Finding(path, 1, "layers", f"engine/{layer_of(path)}/ is not a layer of the list in DESIGN section 3")
            continue
        for number, bracket, target in includes(lines):
            for message in complaints(path, bracket, target):
                yield Finding(path, number, "includes", message)


def complaints(path, bracket, target):
    mine, theirs = layer_of(path), layer_of(target)
    if bracket == '"' and not target.startswith(("engine/", "server/", "truestep/v1/")):
        yield f'"{target}": include paths start at the root ("engine/core/state/state.h")'
    if path.startswith("engine/"):
        if target.startswith("server/"):
            yield "the engine does not know the server"
        if NETWORK.match(target):
            yield f"<{target}>: no network and no command line in the engine"
        if mine and theirs in LAYERS and LAYERS.index(theirs) > LAYERS.index(mine):
            yield f"{mine} may not include {theirs}, which is below it"
        if mine == theirs == "systems":
            a, b = path.split("/")[2:4], target.split("/")[2:4]
            if len(a) == len(b) == 2 and a[0] != b[0]:
                yield f"the system {a[0]} includes the system {b[0]}: share a kernel or write a coupling"
    else:
        if NET.match(target) and not path.startswith("server/net/"):
            yield f"<{target}>: Boost.Asio and Beast belong to server/net alone; others see requests, answers, tasks and executors"
        if target.startswith("CLI/") and path != "server/cli/arguments.cc":
            yield f"<{target}>: CLI11 belongs to server/cli/arguments.cc alone"
        if theirs in PHYSICS:
            yield f"no physics in the server, but this includes {theirs}"
    if GL.match(target) and not path.startswith("engine/sinks/picture"):
        yield f"<{target}>: GL belongs to engine/sinks/picture alone"
