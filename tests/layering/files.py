"""Rules about single files and the README: length, head comment, machine paths, folder table, compiler flags."""
import json
import re
from pathlib import Path

from source import Finding

WARN_LINES, MOST_LINES = 400, 800
MOST_FILES = 27
REASON = re.compile(r"longer than 800 lines because", re.I)
SOURCES = {".cc", ".h", ".py", ".ts", ".js", ".css", ".cmake", ".proto", ".sh"}
COMMENTED = {".cc": "//", ".h": "//", ".proto": "//", ".ts": ("//", "/*"), ".py": ('"""', "#"), ".cmake": "#", ".sh": "#"}
# Written with a bracket each, so that this file does not find itself.
MACHINE = re.compile(r"/wor[k]/|/roo[t]/|/hom[e]/\w|registry\.npm[j]s|python[h]osted|index\.crat[e]s|deb\.debia[n]\.org|pkg\.de[v]\b")
FAST_MATH = re.compile(r"-f(fast|unsafe)-math|-funsafe-math-optimizations|-Ofast|-march=native|-ffp-contract=(fast|on)")


def check_length(tree):
    """Generated files may be as long as they like; they say so in their head."""
    for path in tree.paths:
        if Path(path).suffix in SOURCES and (text := tree.text(path)):
            lines, head = text.count("\n"), "\n".join(text.splitlines()[:12])
            if "@generated" in head:
                continue
            if lines > MOST_LINES and not REASON.search(head):
                yield Finding(path, lines, "length", f"{lines} lines; split it, or say in the head comment: longer than 800 lines because ...")
            elif lines > WARN_LINES:
                yield Finding(path, lines, "length", f"{lines} lines, {WARN_LINES} is a smell", warning=True)


def check_head(tree):
    """The first line that is neither empty, #!, nor #pragma once must be a comment. A .cc may leave it to its .h,
    a unit test to what it tests."""
    for path in tree.paths:
        start = COMMENTED.get(Path(path).suffix)
        if start is None or not (text := tree.text(path)) or path.startswith("tests/unit/") \
                or path.removesuffix(".cc") + ".h" in tree.paths:
            continue
        first = next((line for line in text.splitlines() if line.strip() and not line.startswith(("#!", "#pragma once"))), "")
        if not first.startswith(start):
            yield Finding(path, 1, "head", "no head comment: what is it, with which equation, from which source?")


def check_folder_size(tree):
    """A folder holds some twenty-five files; more wants a subject of its own. Where a file is a target with a name, they are lists."""
    count = {}
    for path in tree.paths:
        if Path(path).suffix in SOURCES:
            count[str(Path(path).parent)] = count.get(str(Path(path).parent), 0) + 1
    for folder, files in sorted(count.items()):
        if files > MOST_FILES and folder not in ("tests/bench", "tests/fuzz", "tests/service"):
            yield Finding(folder, 1, "crowd", f"{files} files, {MOST_FILES} at most: give some of them a folder of their own")


def check_machine_paths(tree):
    for path in tree.paths:
        for number, line in enumerate((tree.text(path) or "").splitlines(), 1):
            if match := MACHINE.search(line):
                yield Finding(path, number, "machine", f"{match[0]!r} names one machine or registry")


def folders_of(tree):
    """Folders that the README explains: those at the root, and instead of engine/ its layers."""
    found = set()
    for path in tree.paths:
        parts = path.split("/")[:-1]
        if parts and parts[0] != "engine" and not parts[0].startswith("."):
            found.add(parts[0] + "/")
        if len(parts) > 1 and parts[0] == "engine":
            found.add("/".join(parts[:2]) + "/")
    return found


def check_folder_table(tree):
    """README.md has a table whose first cells are folders (`engine/base/`): all of them, and none that is gone."""
    if "README.md" not in tree.paths:
        yield Finding("README.md", 1, "folders", "there is no README.md with a folder table", warning=True)
        return
    text, rows = tree.text("README.md"), {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := re.match(r"\|\s*`([\w./-]+/)`\s*\|", line):
            rows[match[1]] = number
    for folder in sorted(folders_of(tree) - set(rows)):
        yield Finding("README.md", 1, "folders", f"the folder table has no row for {folder}")
    for folder in sorted(set(rows) - folders_of(tree)):
        yield Finding("README.md", rows[folder], "folders", f"the folder table names {folder}, which is not there")


def check_casts(tree):
    """What a system offers is a member of its ports, not found by asking for its type."""
    for path, lines in tree.code("engine"):
        for number, line in enumerate(lines, 1):
            if "dynamic_cast" in line.split("//")[0]:
                yield Finding(path, number, "casts", "dynamic_cast: what some systems offer is a member of Ports (core/ports/ports.h)")


def check_flags(tree):
    """No contraction, no fast-math: in the build files, and on every command that compiles a file of ours."""
    build_files = [p for p in tree.paths if p.endswith(("CMakeLists.txt", ".cmake", "CMakePresets.json"))]
    for path in build_files:
        for number, line in enumerate(tree.text(path).splitlines(), 1):
            if match := FAST_MATH.search(line.split("#")[0]):
                yield Finding(path, number, "flags", f"{match[0]} makes results depend on the machine")
    if not any("-ffp-contract=off" in tree.text(p) for p in build_files):
        yield Finding("cmake/options.cmake", 1, "flags", "-ffp-contract=off is missing")
    commands = tree.build and tree.build / "compile_commands.json"
    if commands and commands.exists():
        for entry in json.loads(commands.read_text()):
            path = Path(entry["file"])
            if path.is_relative_to(tree.root / "engine") and "-ffp-contract=off" not in entry["command"]:
                yield Finding(path.relative_to(tree.root).as_posix(), 1, "flags", "compiled without -ffp-contract=off")
