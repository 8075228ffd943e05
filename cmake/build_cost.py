#!/usr/bin/env python3
"""What a build costs, by folder and by object.

build_cost.py table [--build DIR] [--write PAGE]   a table of seconds; --write puts it into a page between its two marks
build_cost.py record LOG COMMAND...                a compiler launcher: runs the command and adds a line to LOG

Seconds are those between a job's start and its end, of .ninja_log, which a busy machine makes longer. A build configured with
-DTRUESTEP_BUILD_COST=ON records CPU seconds (user + system) and the largest resident size of every compiler instead.
"""
import argparse
import collections
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FIRST, LAST = "<!-- cmake/build_cost.py: first line -->", "<!-- cmake/build_cost.py: last line -->"


def record(log, command):
    """Exit code of the command. A line is written at once, so that jobs at the same time do not mix."""
    child = os.posix_spawnp(command[0], command, os.environ)
    _, status, used = os.wait4(child, 0)
    output = command[command.index("-o") + 1] if "-o" in command else command[-1]
    line = f"{used.ru_utime + used.ru_stime:.3f}\t{used.ru_maxrss // 1024}\t{output}\n"
    with open(log, "ab", buffering=0) as file:
        file.write(line.encode())
    return os.waitstatus_to_exitcode(status)


def jobs(build):
    """({output: seconds}, {output: MiB} or {}, what the seconds are) of the last job of every object."""
    costs = build / "build_cost.tsv"
    if costs.exists():
        rows = [line.split("\t") for line in costs.read_text().splitlines()]
        return {out: float(s) for s, _, out in rows}, {out: int(m) for _, m, out in rows}, "CPU seconds"
    rows = [line.split("\t") for line in (build / ".ninja_log").read_text().splitlines()[1:]]
    return {r[3]: (int(r[1]) - int(r[0])) / 1000 for r in rows}, {}, "Seconds of jobs"


def source(build, output):
    """The source of an object, or the first of those that were joined, as a path below the root; None for what is no object."""
    match = re.match(r"(?:(.*)/)?CMakeFiles/[^/]*\.dir/(.*)\.(?:o|gch)$", output)
    if not match:
        return None
    top, path = match[1] or "", match[2]
    if path.startswith("joined/") and (build / top / path).exists():
        return (build / top / path).read_text().split('"')[1]
    return f"{top}/{path}"


def folder(path):
    parts = path.split("/")
    return "/".join(parts[:2]) if len(parts) > 2 else f"{parts[0]} (precompiled header, generated)"


def table(build):
    seconds, sizes, kind = jobs(build)
    sums, counts, dearest = collections.Counter(), collections.Counter(), {}
    objects = []
    for output, spent in seconds.items():
        if path := source(build, output):
            sums[folder(path)] += spent
            counts[folder(path)] += 1
            name = output.split(".dir/")[1].removesuffix(".o")
            objects.append((spent, name, sizes.get(output)))
            dearest[folder(path)] = max(dearest.get(folder(path), (0, "")), (spent, name))
    total = sum(sums.values())
    yield f"{kind}: {total:.0f} in {sum(counts.values())} objects."
    yield ""
    yield "| folder | s | share | objects | dearest object | s |"
    yield "| --- | ---: | ---: | ---: | --- | ---: |"
    for name, spent in sums.most_common():
        yield f"| {name} | {spent:.1f} | {spent / total:.0%} | {counts[name]} | {dearest[name][1]} | {dearest[name][0]:.1f} |"
    yield ""
    yield "| dearest objects | s |" + (" MiB |" if sizes else "")
    yield "| --- | ---: |" + (" ---: |" if sizes else "")
    for spent, name, size in sorted(objects, reverse=True)[:15]:
        yield f"| {name} | {spent:.1f} |" + (f" {size} |" if sizes else "")


def write(page, lines):
    text = page.read_text()
    before, rest = text.split(FIRST)
    page.write_text(before + "\n".join([FIRST, "", *lines, "", LAST]) + rest.split(LAST)[1])


def main():
    if sys.argv[1:2] == ["record"]:
        return record(sys.argv[2], sys.argv[3:])
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["table"])
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--write", type=Path, metavar="PAGE")
    options = parser.parse_args()
    lines = list(table(options.build))
    if options.write:
        write(options.write, lines)
    else:
        print(*lines, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
