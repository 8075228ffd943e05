"""What the engine's object files import, read with nm.

The step path imports no transcendental of libm: those differ between processors, so hashes would too. Exact
functions (sqrt, fma, floor, fmod ...) are free. Setup code that may differ in the last bit is listed in
libm_exceptions.txt with its reason.

No layer calls what is defined in a layer below it, even where the declaration stands in a layer above.
"""
import re
import subprocess

from includes import LAYERS, layer_of
from source import Finding

STEP_LAYERS = ["base", "math", "geometry", "kernels", "neighbours", "core", "integrators", "collision", "lattice", "rigid", "systems", "couplings", "session"]
NAMES = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sincos", "sinh", "cosh", "tanh", "asinh", "acosh",
         "atanh", "exp", "exp2", "exp10", "expm1", "log", "log2", "log10", "log1p", "pow", "cbrt", "hypot", "erf",
         "erfc", "tgamma", "lgamma"]
INEXACT = {name + suffix for name in NAMES for suffix in ("", "f", "l")}


def exceptions(tree):
    """{path: set of symbols} of libm_exceptions.txt; a line is `path: symbol symbol -- reason`."""
    allowed = {}
    path = "tests/layering/libm_exceptions.txt"
    for line in (tree.text(path) if path in tree.paths else "").splitlines():
        if line.strip() and not line.startswith("#"):
            file, rest = line.split(":", 1)
            symbols, reason = rest.split("--", 1)
            if reason.strip():
                allowed[file.strip()] = set(symbols.split())
    return allowed


def undefined(objects):
    """{object: undefined symbols without their version} of object files."""
    found, current = {}, None
    listing = subprocess.run(["nm", "-u", "-A", "--format=posix", *objects], capture_output=True, text=True, check=True)
    for line in listing.stdout.splitlines():
        name, rest = line.split(": ", 1)
        found.setdefault(name, set()).add(rest.split()[0].split("@")[0])
    return found


def sources_of_objects(tree, layers):
    """{object: one of its sources}. Joined sources are of one folder, and files with exceptions are never joined; an
    object of a source that has since gone is no evidence."""
    top = tree.build / "engine/CMakeFiles/truestep_engine.dir"
    sources = {}
    for path in sorted(top.glob("**/*.o")):
        if "joined" in path.parts:
            joined = tree.build / "engine" / path.relative_to(top).with_suffix("")
            names = re.findall(r'"(engine/[^"]*)"', joined.read_text()) if joined.exists() else []
        else:
            names = ["engine/" + path.relative_to(top).as_posix().removesuffix(".o")]
        if names and all(n in tree.paths for n in names) and layer_of(names[0]) in layers:
            sources[str(path)] = names[0]
    return sources


def check(tree):
    if tree.build is None:
        return
    allowed = exceptions(tree)
    for path in sorted(set(allowed) - set(tree.paths)):
        yield Finding("tests/layering/libm_exceptions.txt", 1, "libm", f"{path} is not there any more")
    objects = sources_of_objects(tree, STEP_LAYERS)
    if not objects:
        yield Finding("engine", 1, "libm", f"no object files below {tree.build}: build first")
        return
    for name, symbols in sorted(undefined(objects).items()):
        path = objects[name]
        for symbol in sorted((symbols & INEXACT) - allowed.get(path, set())):
            yield Finding(path, 1, "libm", f"imports {symbol} of libm: use engine/math/trig.h, or list it with its reason")


def check_calls(tree):
    """Symbols that a file imports and that only a layer below its own defines."""
    if tree.build is None:
        return
    objects = sources_of_objects(tree, LAYERS)
    if not objects:
        yield Finding("engine", 1, "calls", f"no object files below {tree.build}: build first")
        return
    listing = subprocess.run(["nm", "-A", "--format=posix", *objects], capture_output=True, text=True, check=True)
    defined, imported = {}, []
    for line in listing.stdout.splitlines():
        name, rest = line.split(": ", 1)
        symbol, kind = rest.split()[:2]
        path = objects[name]
        # Weak symbols (inline functions, templates) have a copy in every file that uses them.
        if kind in "TDBR":
            defined[symbol] = path
        elif kind == "U":
            imported.append((path, symbol))
    for path, symbol in sorted(imported):
        there = defined.get(symbol)
        if there and LAYERS.index(layer_of(there)) > LAYERS.index(layer_of(path)):
            plain = subprocess.run(["c++filt", symbol], capture_output=True, text=True, check=True).stdout.strip()
            yield Finding(path, 1, "calls", f"{layer_of(path)} calls {plain} of {there}, which is below it")
