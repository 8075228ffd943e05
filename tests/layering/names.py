"""One type, one name: no two headers define a type of the same qualified name, and none that a source file defines for itself
outside an anonymous namespace. Two definitions of one name are undefined behaviour that no linker reports. A system and a
coupling have a namespace of their own, named as their folder.
"""
import collections
import re

from source import Finding

SILENT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
TOKEN = re.compile(
    r"(?P<space>\bnamespace\b\s*(?P<path>[\w:]*)\s*\{)"
    r"|(?P<type>\b(?:struct|class|union|enum(?:\s+class)?)\s+(?:alignas\([^)]*\)\s*)?(?P<name>\w+(?:::\w+)*)\s*(?P<special><[^;{}]*>)?"
    r"(?:\s+final)?\s*(?::[^;{}()]*)?\{)"
    r"|(?P<open>\{)|(?P<close>\})")


def blank(match):
    """As many lines as what is left out."""
    return "\n" * match[0].count("\n")


def types(text):
    """(qualified name, line) of every type that is defined in a namespace, specialisations left out."""
    text = SILENT.sub(blank, text)
    around = []  # (name, is a namespace) of every brace that is open
    for match in TOKEN.finditer(text):
        if match["space"]:
            around.append((match["path"] or "(anonymous)", True))
        elif match["type"]:
            if all(is_space for _, is_space in around) and not match["special"] and "::" not in match["name"]:
                names = [name for name, _ in around]
                if "(anonymous)" not in names:
                    yield "::".join([*names, match["name"]]), text.count("\n", 0, match.start()) + 1
            around.append((match["name"], False))
        elif match["open"]:
            around.append(("", False))
        elif around:
            around.pop()


OWN = re.compile(r"^engine/(?:systems|couplings)/(\w+)/")


def foreign(path, text):
    """(name, line) of the namespaces that a file of a system or coupling opens beside its own."""
    folder = OWN.match(path)
    if not folder:
        return
    depth = 0
    for match in TOKEN.finditer(SILENT.sub(blank, text)):
        if match["space"]:
            path = match["path"]
            if depth == 0 and path and path != "truestep::" + folder[1] and not path.startswith(f"truestep::{folder[1]}::"):
                yield path, text.count("\n", 0, match.start()) + 1
        depth += -1 if match["close"] else 1


def check(tree):
    for path, lines in tree.code("engine"):
        for name, line in foreign(path, "\n".join(lines)):
            yield Finding(path, line, "names", f"{name}: what a system or coupling defines is in truestep::{OWN.match(path)[1]}")
    places = collections.defaultdict(list)
    for path, lines in tree.code("engine", "server"):
        for name, line in types("\n".join(lines)):
            places[name].append((path, line))
    for name, where in sorted(places.items()):
        first = where[0][0]
        for path, line in where[1:]:
            if path != first:
                yield Finding(path, line, "names", f"{name} is defined in {first} too: a namespace per subject, or another name")
