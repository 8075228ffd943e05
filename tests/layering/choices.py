"""What may differ between two builds of one commit: instruction sets that are asked for everywhere alike, reference engines that a
scene names, and nothing that decides a number by what happens to be installed."""
import re

from source import Finding

# Instruction sets and systems; what the compiler is, which only the version tells.
ANYWHERE = {"__AVX2__", "__FMA__", "__x86_64__", "__aarch64__"}
# Definitions of the build, each where it is read.
ALLOWED = {
    "engine/base/version.cc": {"__clang__", "__aarch64__", "__OPTIMIZE__"},
    "engine/base/parallel.cc": {"TRUESTEP_PLAIN_THREADS"},
    "engine/base/thread_team.cc": {"TRUESTEP_PLAIN_THREADS"},
    # The same sums in wider registers, chosen when the program runs.
    "engine/kernels/gravity/lanes/plain_loops.cc": {"TRUESTEP_AVX512"},
    "engine/kernels/sph/wide/choice.cc": {"TRUESTEP_AVX512"},
    # Other people's engines are refused where they are missing.
    "engine/reference/engines.cc": {"TRUESTEP_BULLET", "TRUESTEP_BOX2D"},
    # In the text of a shader.
    "engine/sinks/picture/gl/shaders.cc": {"SHADOW"},
}
CONDITION = re.compile(r"\s*#\s*(?:if|ifdef|ifndef|elif)\b(.*)")
NAME = re.compile(r"[A-Za-z_]\w*")
# An option whose default is what was found; a condition on what was found.
BY_PRESENCE = re.compile(r"\boption\(\w+\s+\"[^\"]*\"\s+\$\{|\bif\(.*_(?:FOUND|LIBRARY|LIBRARIES|INCLUDE_DIRS?)\b", re.I)


def check(tree):
    for path, lines in tree.code("engine"):
        for number, line in enumerate(lines, 1):
            if not (match := CONDITION.match(line)):
                continue
            names = set(NAME.findall(match[1].split("//")[0])) - {"defined"}
            for name in sorted(names - ANYWHERE - ALLOWED.get(path, set())):
                yield Finding(path, number, "choices", f"{name} makes two builds of one commit differ (tests/layering/choices.py)")
    for path in tree.paths:
        if path not in ("engine/CMakeLists.txt", "cmake/dependencies.cmake"):
            continue
        for number, line in enumerate(tree.text(path).splitlines(), 1):
            if (match := BY_PRESENCE.search(line.split("#")[0])) and not line.lstrip().startswith("if(NOT"):
                yield Finding(path, number, "choices", f"{match[0]!r}: what is installed chooses what the program does")
