"""Names that only one file sees: the .cc files of a folder are compiled several at a time (cmake/unity.cmake), so what one of
them defines in an anonymous namespace, or as `static`, no other file of its folder may define once more. Functions may overload
each other, and a name may be given twice to one and the same thing (namespace json = boost::json). A macro that a file defines
ends in that file.
"""
import collections
import re

from source import Finding

SILENT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])*\'', re.S)
MACRO = re.compile(r"^[ \t]*#[ \t]*(define|undef)[ \t]+(\w+)", re.M)
DIRECTIVE = re.compile(r"^[ \t]*#(?:\\\n|[^\n])*", re.M)
NAMESPACE = re.compile(r"(?:inline\s+)?namespace\s*([\w:]*)\s*$")
TYPE = re.compile(r"(?:struct|class|union|enum(?:\s+class|\s+struct)?)\s+(?:alignas\([^)]*\)\s*|\[\[[^\]]*\]\]\s*)?(\w+)(?!\s*\()")
ALIAS = re.compile(r"(?:using|namespace)\s+(\w+)\s*=\s*(.*)", re.S)
ATTRIBUTE = re.compile(r"\[\[.*?\]\]|__attribute__\s*\(\(.*?\)\)|alignas\s*\([^)]*\)")
VARIABLE = re.compile(r"([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)*$")
ENUMERATION = re.compile(r"enum\b(?!\s+(?:class|struct)\b)")
ENUMERATOR = re.compile(r"\s*(\w+)")
# Every .cc of these is a program.
PROGRAMS = re.compile(r"^tests/(bench|fuzz)$|/(campaign|estimates|fixtures)$")


def blank(match):
    """As many lines as what is left out; a literal stays something to compare."""
    return "\n" * match[0].count("\n") or ("0" if match[0][0] in "\"'R" else "")


def closing(text, start):
    """Where the bracket at `start` is closed."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(text[at], 0)
        if depth == 0:
            return at
    return len(text)


def end_of_statement(text, start):
    """The semicolon after the bracket at `start` and what belongs to it."""
    end = text.find(";", closing(text, start))
    return end if end >= 0 else len(text)


def without_template(text):
    while match := re.match(r"\s*template\s*<", text):
        depth, at = 1, match.end()
        while depth and at < len(text):
            depth += {"<": 1, ">": -1}.get(text[at], 0) if text[at - 1] != "-" else 0
            at += 1
        text = re.sub(r"^\s*requires\s+[\w:]+(<[^<>]*>)?", "", text[at:])
    return text.strip()


def parameters(text):
    """The types of a parameter list, without the parameters' names and defaults."""
    found = []
    for part in pieces(text):
        part = re.sub(r"\s+", " ", part.split("=")[0]).strip()
        if re.search(r"[\w>&*\]] ?\b\w+$", part) and " " in part or re.search(r"[>&*]\w+$", part):
            part = re.sub(r" ?\b\w+$", "", part)
        # A namespace may be named or not.
        found.append(re.sub(r"\w+::", "", re.sub(r" ?([<>&*,:()]) ?", r"\1", part)))
    return ",".join(found)


def pieces(text):
    """The text split at commas outside of brackets."""
    found, depth = [""], 0
    for letter in text:
        depth += {"<": 1, "(": 1, "{": 1, "[": 1, ">": -1, ")": -1, "}": -1, "]": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return found


def declared(head, has_body):
    """What a declaration at namespace scope defines: names, that of a function with its parameters' types."""
    head = without_template(ATTRIBUTE.sub(" ", head))
    if match := ALIAS.match(head):
        return [f"{match[1]} = {re.sub(chr(92) + 's+', '', match[2])}"]
    if has_body and re.match(r"enum\s*[:{]|enum$", head):
        return []
    if has_body and (match := TYPE.match(head)) and not re.search(r"[=(]", head[match.end():]):
        return [match[1]]
    if not head or re.match(r"(using|typedef|friend|extern|static_assert|template|struct|class|enum|union)\b", head):
        return []
    depth = 0
    for at, letter in enumerate(head):
        depth += {"<": 1, ">": -1}.get(letter, 0)
        if letter == "=" and depth == 0 and not re.search(r"operator\s*[=!<>+*/-]?$", head[:at]):
            break
        if letter == "(" and depth <= 0 and (match := re.search(r"(operator\s*\W+|[\w:]+)\s*$", head[:at])):
            is_defined_here = has_body and "::" not in match[1]
            return [f"{match[1]}({parameters(head[at + 1:closing(head, at)])})"] if is_defined_here else []
    return [match[1] for piece in pieces(head) if (match := VARIABLE.search(re.split("[={]", piece)[0].rstrip()))]


def is_function(head):
    """Whether a body belongs to a function; parameters may have defaults."""
    while (start := head.find("(")) >= 0:
        head = head[:start] + "<>" + head[closing(head, start) + 1:]
    return re.search(r">\s*(const|noexcept|override|->[^={;]*|requires[^={;]*)*\s*$", head) is not None \
        and "=" not in re.sub(r"operator\s*\W+", "", head) and "<>" in head


def private_names(text):
    """(qualified name, line) of what a file alone sees."""
    text = DIRECTIVE.sub(blank, SILENT.sub(blank, text))
    spaces, start, at = [], 0, 0
    while at < len(text):
        letter = text[at]
        if letter in "([":
            at = closing(text, at)
        elif letter == "}":
            if spaces:
                spaces.pop()
            start = at + 1
        elif letter in "{;":
            head = text[start:at].strip()
            if letter == "{" and (match := NAMESPACE.match(head)):
                spaces.append(match[1] or "{anonymous}")
                start = at + 1
            else:
                private = "{anonymous}" in spaces or re.match(r"(?:template\s*<.*>\s*)?static\s", head)
                function = is_function(head)
                if head and (private or head.startswith("namespace ")):
                    line = text.count("\n", 0, at - len(text[start:at].lstrip())) + 1
                    if letter == "{" and not function and not TYPE.match(without_template(head)) and not ENUMERATION.match(head):
                        at = end_of_statement(text, at)
                        head, letter = text[start:at], ";"
                    names = declared(head, letter == "{")
                    if letter == "{" and ENUMERATION.match(head):
                        names += [match[1] for piece in pieces(text[at + 1:closing(text, at)]) if (match := ENUMERATOR.match(piece))]
                    for name in names:
                        yield "::".join([*(s for s in spaces if s != "{anonymous}"), name]), line
                if letter == "{":
                    at = closing(text, at) if function else end_of_statement(text, at)
                start = at + 1
        at += 1


def open_macros(text):
    """{name: line} of the macros that are still defined where the file ends."""
    found = {}
    for match in MACRO.finditer(SILENT.sub(blank, text)):
        if match[1] == "define":
            found[match[2]] = text.count("\n", 0, match.start()) + 1
        else:
            found.pop(match[2], None)
    return found


def check(tree):
    folders = collections.defaultdict(list)
    for path, lines in tree.code("engine", "server", "tests"):
        folder = path.rpartition("/")[0]
        if path.endswith(".cc") and not PROGRAMS.search(folder):
            folders[folder].append((path, "\n".join(lines)))
    for folder, files in sorted(folders.items()):
        places, aliases = {}, {}
        for path, text in files:
            for name, line in open_macros(text).items():
                yield Finding(path, line, "anonymous", f"#define {name} goes on in the files that are compiled with this one: #undef it where it ends")
            for name, line in dict(private_names(text)).items():
                plain, _, meaning = name.partition(" = ")
                there = places.setdefault(plain, path)
                if there != path and not (meaning and aliases.get(plain) == meaning):
                    yield Finding(path, line, "anonymous", f"{plain} is defined in {there} too, and files of a folder are compiled together: another name")
                aliases.setdefault(plain, meaning)
