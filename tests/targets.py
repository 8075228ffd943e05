#!/usr/bin/env python3
"""targets.py BUILD CTEST_OPTION...: the build targets that tests need which these options choose, one a line. Tests of
executables that are not built yet are found in their sources. `fuzz_targets` are those in the tree of the preset asan,
`venv` stands for Python packages, Chromium and what else only the tier full installs. What nothing is known of may need anything: tests_full."""
import json
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
KINDS = ("unit", "convergence", "validation", "stability", "determinism", "crosscheck", "service")
TEST = re.compile(r"^\s*(?:TYPED_)?TEST(_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)", re.M)
INSTANCE = re.compile(r"INSTANTIATE_\w*SUITE_P\(\s*(\w+)\s*,\s*(\w+)", re.M)


def chosen(options):
    """Regular expressions of names and of labels."""
    names, labels, rest = [], [], list(options)
    while rest:
        word = rest.pop(0)
        for list_, short, long in ((names, "-R", "--tests-regex"), (labels, "-L", "--label-regex")):
            if word in (short, long) and rest:
                list_.append(rest.pop(0))
    return names, labels


def in_sources(kind):
    """Names of a kind's tests as ctest would list them, without their parameters."""
    for path in (HERE / kind).rglob("*.cc"):
        text = path.read_text()
        prefixes = {}
        for prefix, suite in INSTANCE.findall(text):
            prefixes.setdefault(suite, []).append(prefix)
        for _, suite, name in TEST.findall(text):
            yield f"{kind}.{suite}.{name}"
            for prefix in prefixes.get(suite, ()):
                yield f"{kind}.{prefix}/{suite}.{name}/0"


def listed(build, options):
    """What ctest knows of the chosen tests: commands and environments, as text."""
    run = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1", *options], stdout=subprocess.PIPE,
                         stderr=subprocess.DEVNULL, text=True)
    for test in json.loads(run.stdout or "{}").get("tests", ()):
        yield json.dumps([test.get("command"), test.get("properties")])


def main():
    build, options = Path(sys.argv[1]).resolve(), sys.argv[2:]
    names, labels = chosen(options)
    targets = set()
    for text in listed(build, options):
        targets |= set(re.findall(re.escape(f"{build}/bin/") + r"(\w+)", text))
        if "build/asan" in text or '"fuzz"' in text:
            targets.add("fuzz_targets")
        if "build/venv" in text or '"browser"' in text or "tests/service" in text:
            targets.add("venv")
        if "layering" in text or "readme_test" in text:
            targets.add("truestep")
        if "driver.py" in text:
            targets.add("bench_fixed_sum")
    for kind in KINDS:
        if all(re.search(label, kind) for label in labels) and \
                any(all(re.search(pattern, name) for pattern in names) for name in in_sources(kind)):
            targets.add(f"test_{kind}")
    print("\n".join(sorted(targets or {"tests_full", "venv"})))


if __name__ == "__main__":
    main()
