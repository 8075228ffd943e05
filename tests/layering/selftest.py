#!/usr/bin/env python3
"""Every rule finds what it is there to find: a small clean tree passes, and the same tree with one fault fails
with exactly that rule."""
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import check
import format as formatting
from source import Tree

HEAD = "// A file of the control tree.\n"
CLEAN = {
    "README.md": "".join(f"| `{f}/` | x |\n" for f in (
        "cmake", "engine/base", "engine/kernels", "engine/systems", "engine/sinks", "server")),
    "cmake/options.cmake": "# Flags.\nadd_compile_options(-ffp-contract=off)\n",
    "cmake/unity.cmake": "# Joins.\n",
    "engine/base/errors.h": HEAD + "#pragma once\n",
    "engine/kernels/drag.h": HEAD + '#pragma once\n#include "engine/base/errors.h"\n',
    "engine/systems/sph/step.cc": HEAD + '#include "engine/kernels/drag.h"\n#include <vector>\n'
                                  "namespace truestep::sph {\nstruct Drag {\n  struct Inner {};\n};\nnamespace {\nstruct Own {};\nenum { kOwn };\n}\n}\n",
    "engine/sinks/picture/gl.cc": HEAD + "#include <GL/osmesa.h>\n",
    "server/main.cc": HEAD + '#include "engine/sinks/picture.h"\n',
    "server/net/timer.cc": HEAD + "#include <boost/asio/steady_timer.hpp>\n",
    "server/cli/arguments.cc": HEAD + "#include <CLI/CLI.hpp>\n",
}
# rule: (file, text added at its end), each a fault of its own.
FAULTS = [
    ("includes", "engine/kernels/drag.h", '#include "engine/core/state/state.h"\n', "a layer below"),
    ("includes", "engine/base/errors.h", '#include "engine/session/session.h"\n', "far below"),
    ("includes", "engine/kernels/drag.h", '#include "drag_table.h"\n', "a path not from the root"),
    ("includes", "engine/systems/sph/step.cc", '#include "engine/systems/cloth/step.h"\n', "a sibling system"),
    ("includes", "engine/systems/sph/step.cc", '#include "server/cli/cli.h"\n', "the server"),
    ("includes", "engine/sinks/picture/gl.cc", "#include <sys/socket.h>\n", "a socket"),
    ("includes", "engine/base/errors.h", "#include <boost/beast/http.hpp>\n", "HTTP"),
    ("includes", "server/main.cc", "#include <boost/asio/post.hpp>\n", "Asio outside server/net"),
    ("includes", "server/main.cc", "#include <boost/beast.hpp>\n", "Beast outside server/net"),
    ("includes", "server/net/timer.cc", "#include <CLI/App.hpp>\n", "CLI11 outside its file"),
    ("includes", "engine/systems/sph/step.cc", "#include <GL/gl.h>\n", "GL outside the picture sink"),
    ("includes", "server/main.cc", '#include "engine/systems/sph/step.h"\n', "physics in the server"),
    ("includes", "server/main.cc", '#  include "engine/kernels/drag.h"\n', "physics, spaces before include"),
    ("names", "engine/kernels/drag.h", "namespace truestep::sph {\nstruct Drag {};\n}\n", "a type that another file defines"),
    ("names", "engine/systems/sph/step.cc", "namespace truestep {\nvoid step();\n}\n", "a system outside its namespace"),
    ("layers", "engine/misc/junk.h", HEAD, "a folder that is no layer"),
    ("length", "engine/base/errors.h", "\n" * 801, "more than 800 lines"),
    ("head", "server/run.cc", "int x;\n", "no head comment"),
    ("machine", "server/main.cc", "// see /wor" + "k/main\n", "a path of one machine"),
    ("machine", "README.md", "npm --registry https://registry.npm" + "js.org\n", "a registry"),
    ("folders", "README.md", "| `engine/gone/` | x |\n", "a row for no folder"),
    ("folders", "web/main.ts", "// Viewer.\n", "a folder without a row"),
    ("casts", "engine/core/thing.cc", "bool tall(const System& s) { return dynamic_cast<const Tall*>(&s); }\n", "dynamic_cast"),
    ("flags", "cmake/options.cmake", "add_compile_options(-ffast-math)\n", "fast-math"),
    ("flags", "cmake/options.cmake", "add_compile_options(-march=native)\n", "one machine's instructions"),
    ("anonymous", "engine/systems/sph/state.cc", HEAD + "namespace truestep::sph {\nnamespace {\nconstexpr int kRest{1}, kOwn = 2;\n}\n}\n", "a name of a file beside it"),
    ("anonymous", "engine/systems/sph/step.cc", "#define SPH_ROWS 3\n", "a macro that goes on in the next file"),
    ("controls", "tests/scenes/rigid/drop.json", '{"test": {"vary": {"dt": [0.1]}}}\n', "a scene test without a control"),
    ("controls", "tests/scenes/refused/drop.json", '{"test": {"cases": [{"refused": {}}]}}\n', "refusals without a sound scene"),
    ("choices", "engine/systems/sph/step.cc", "#ifdef TRUESTEP_KLU\n#endif\n", "a library where it was installed"),
    ("choices", "engine/systems/sph/step.cc", "#if __has_include(<klu.h>)\n#endif\n", "a header where it was installed"),
    ("choices", "cmake/dependencies.cmake", 'option(TRUESTEP_KLU "Sparse" ${klu_is_present})\n', "an option by what is installed"),
    ("choices", "engine/CMakeLists.txt", "if(KLU_FOUND)\nendif()\n", "a condition on what is installed"),
]


class Rules(unittest.TestCase):
    def setUp(self):
        self.root = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)
        for path, text in CLEAN.items():
            self.write(path, text)

    def write(self, path, text, mode="w"):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        with open(self.root / path, mode) as file:
            file.write(text)

    def broken(self, build=None):
        return {f.rule for f in check.run(Tree(self.root, build), check.RULES) if not f.warning}

    def test_the_clean_tree_passes(self):
        self.assertEqual(self.broken(), set())

    def test_every_fault_is_found_by_its_rule(self):
        for rule, path, text, what in FAULTS:
            with self.subTest(what):
                before = (self.root / path).read_text() if (self.root / path).exists() else None
                self.write(path, text, "a")
                self.assertIn(rule, self.broken())
                (self.root / path).unlink() if before is None else self.write(path, before)

    def test_every_rule_has_a_fault(self):
        self.assertEqual(set(check.RULES) - {"libm", "calls", "crowd"} - {rule for rule, *_ in FAULTS}, set())

    def test_a_crowded_folder_is_found(self):
        for number in range(28):
            self.write(f"engine/systems/sph/part_{number}.h", HEAD + "#pragma once\n")
            self.write(f"server/part_{number}.h", HEAD + "#pragma once\n")
        found = [f.path for f in check.run(Tree(self.root), ["crowd"])]
        self.assertEqual(found, ["engine/systems/sph", "server"])
        (self.root / "server/part_1.h").unlink(), (self.root / "server/part_2.h").unlink()
        self.assertEqual([f.path for f in check.run(Tree(self.root), ["crowd"])], ["engine/systems/sph"])

    def test_overloads_names_given_twice_and_files_of_other_folders_are_free(self):
        body = "namespace truestep::sph {\nnamespace {\nnamespace json = boost::json;\nint begin(%s x) { return 1; }\n}\n}\n"
        for name, kind in (("sph/a", "int"), ("sph/b", "const Drag&"), ("cloth/a", "int")):
            self.write(f"engine/systems/{name}.cc", HEAD + (body % kind).replace("sph", name.split("/")[0]))
        self.assertEqual(self.broken(), set())
        self.write("engine/systems/sph/c.cc", HEAD + body % "int")
        self.assertEqual(self.broken(), {"anonymous"})

    def test_a_missing_contraction_flag_is_found(self):
        self.write("cmake/options.cmake", "# Flags.\n")
        self.assertEqual(self.broken(), {"flags"})

    def test_a_long_file_with_a_reason_passes_and_401_lines_warn(self):
        self.write("engine/base/errors.h", "// Longer than 800 lines because it is one table.\n" + "\n" * 900)
        self.assertEqual(self.broken(), set())
        self.write("engine/base/errors.h", HEAD + "\n" * 401)
        self.assertEqual([f.rule for f in check.run(Tree(self.root), ["length"]) if f.warning], ["length"])

    def compile(self, body):
        """A build folder whose one object file is kernels/wave.cc with this body."""
        source = "engine/kernels/wave.cc"
        self.write(source, f"{HEAD}#include <cmath>\ndouble f(double x) {{ return {body}; }}\n")
        build = self.root / "build"
        target = build / "engine/CMakeFiles/truestep_engine.dir/kernels/wave.cc.o"
        target.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["c++", "-c", self.root / source, "-o", target], check=True)
        return build

    def test_libm_imports_are_found_and_exact_functions_are_free(self):
        self.assertEqual(self.broken(self.compile("std::sqrt(x) + std::floor(x) + std::fma(x, x, x)")), set())
        self.assertEqual(self.broken(self.compile("std::pow(x, x)")), {"libm"})

    def test_joined_sources_are_judged_as_their_folder(self):
        top = self.compile("std::pow(x, x)") / "engine/CMakeFiles/truestep_engine.dir"
        joined, compiled = self.root / "build/engine/joined/kernels_0.cc", top / "joined/kernels_0.cc.o"
        joined.parent.mkdir(), compiled.parent.mkdir()
        joined.write_text('#include "engine/kernels/wave.cc"\n')
        (top / "kernels/wave.cc.o").rename(compiled)
        self.assertEqual(self.broken(self.root / "build"), {"libm"})
        # Of sources that are not there any more nothing is known.
        joined.write_text('#include "engine/kernels/gone.cc"\n')
        self.assertIn("build first", " ".join(str(f) for f in check.run(Tree(self.root, self.root / "build"), ["libm"])))

    def test_a_call_into_a_layer_below_is_found_although_it_is_declared_above(self):
        build = self.compile("x * x")
        top = build / "engine/CMakeFiles/truestep_engine.dir"
        for source, body in (("engine/base/table.cc", "double limit(int);\ndouble twice(int i) { return 2 * limit(i); }\n"),
                             ("engine/kernels/table.cc", "double limit(int i) { return i; }\n")):
            self.write(source, HEAD + body)
            target = top / (source.removeprefix("engine/") + ".o")
            target.parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(["c++", "-c", self.root / source, "-o", target], check=True)
        found = [str(f) for f in check.run(Tree(self.root, build), ["calls"])]
        self.assertEqual(len(found), 1, found)
        self.assertIn("base calls limit(int) of engine/kernels/table.cc", found[0])
        # The other way round is what layers are for.
        (top / "base/table.cc.o").rename(top / "kernels/user.cc.o"), (top / "kernels/table.cc.o").rename(top / "base/table.cc.o")
        self.write("engine/kernels/user.cc", HEAD)
        self.assertEqual(check.run(Tree(self.root, build), ["calls"]), [])

    def test_an_exception_needs_the_file_the_symbol_and_a_reason(self):
        build = self.compile("std::sin(x)")
        where = "tests/layering/libm_exceptions.txt"
        self.write("README.md", "| `tests/` | x |\n", "a")
        self.write(where, "engine/kernels/wave.cc: sin -- set once, before the first step\n")
        self.assertEqual(self.broken(build), set())
        self.write(where, "engine/kernels/wave.cc: cos -- set once, before the first step\n")
        self.assertEqual(self.broken(build), {"libm"})
        self.write(where, "engine/kernels/gone.cc: sin -- set once\n")
        gone = [f for f in check.run(Tree(self.root, build), ["libm"]) if "gone.cc" in f.message]
        self.assertEqual(len(gone), 1)

    def test_a_build_without_objects_is_no_pass(self):
        self.assertEqual(self.broken(self.root / "build"), {"libm", "calls"})

    def test_the_formatter_sees_a_badly_formatted_file(self):
        shutil.copy(Path(__file__).resolve().parents[2] / ".clang-format", self.root)
        self.assertEqual(formatting.unformatted(self.root, ["engine/base/errors.h"]), [])
        self.write("engine/base/errors.h", "int   x ;\n", "a")
        self.assertIn("errors.h", formatting.unformatted(self.root, ["engine/base/errors.h", "engine/base/utf8.h"])[0])


if __name__ == "__main__":
    sys.exit(unittest.main())
