#!/usr/bin/env python3
"""What an installation holds: the library that docs/library.md describes, the program, its Debian package.

installed_test.py BUILD [unittest options]
"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from patience import patience

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else ROOT / "build/release"
VERSION = re.search(r"project\(truestep VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def run(*command, cwd=None, code=0):
    """Standard output of a command that ends with `code`."""
    done = subprocess.run([str(c) for c in command], cwd=cwd, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=patience(300))
    if done.returncode != code:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout[-3000:]}")
    return done.stdout


def runtime_packages():
    text = (ROOT / "cmake/apt-packages.txt").read_text()
    return re.search(r"^\[runtime\]\n(.*?)(?=^\[|\Z)", text, re.M | re.S)[1].split()


def loaded_packages(binary):
    """Debian packages of the libraries that a binary names itself."""
    names = re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", binary))
    paths = dict(re.findall(r"^\s*(\S+) => (\S+) ", run("ldd", binary), re.M))
    return {owner_of(paths[name]) for name in names if not name.startswith("ld-linux")}


def owner_of(path):
    """The package that a file is from. /lib is a link to /usr/lib, and packages name either."""
    below = path.removeprefix("/usr")
    done = subprocess.run(["dpkg-query", "-S", below, f"/usr{below}"], text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return done.stdout.split(":")[0]


class Folder(unittest.TestCase):
    """A temporary folder a test."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="truestep-installed-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def install(self, component):
        run("cmake", "--install", BUILD, "--component", component, "--prefix", self.folder / "usr", "--strip")
        return self.folder / "usr"


class Library(Folder):
    def example(self):
        """The files of docs/library.md, and where they were written."""
        page = (ROOT / "docs/library.md").read_text()
        files = re.findall(r"^`([\w.]+)`:\n\n```\w+\n(.*?)^```$", page, re.M | re.S)
        self.assertEqual([name for name, _ in files], ["CMakeLists.txt", "falling.cc"])
        for name, text in files:
            (self.folder / name).write_text(text)

    def configure(self, prefix, *options, code=0):
        # Nothing of the source tree or its build is in reach but by the installation.
        return run("cmake", "-S", self.folder, "-B", self.folder / "build", f"-DCMAKE_PREFIX_PATH={prefix}", *options, code=code)

    def test_the_example_of_its_page_runs(self):
        prefix = self.install("library")
        self.example()
        self.configure(prefix, "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", self.folder / "build")
        said = run(self.folder / "build/falling")
        self.assertRegex(said, r"^t = 1 s, energy -?[0-9.e-]+ J\nits end is at .*\nthe same bits\n$")

    def test_names_no_folder_of_the_build(self):
        prefix = self.install("library")
        for file in prefix.rglob("*.cmake"):
            self.assertNotIn(str(ROOT), file.read_text(), file.name)
        for folder in ("scenes", "proto/truestep/v1"):
            self.assertTrue(any((prefix / "share/truestep" / folder).iterdir()), folder)

    def test_another_minor_version_is_refused(self):
        prefix = self.install("library")
        self.example()
        page = self.folder / "CMakeLists.txt"
        page.write_text(re.sub(r"truestep \d+\.\d+", "truestep 0.1", page.read_text()))
        self.assertIn("version", self.configure(prefix, code=1))


class Program(Folder):
    def test_it_runs_and_says_its_version(self):
        prefix = self.install("program")
        self.assertEqual(run(prefix / "bin/truestep", "--version", cwd=self.folder).strip(), VERSION)
        self.assertIn("hanging_cloth", run(prefix / "bin/truestep", "gallery", cwd=self.folder))

    def test_the_man_page_lists_every_command_and_no_other(self):
        prefix = self.install("program")
        page = (prefix / "share/man/man1/truestep.1").read_text()
        self.assertIn(f"truestep {VERSION}", page)
        told = re.search(r"^Subcommands:\n(.*)", run(prefix / "bin/truestep", "--help"), re.M | re.S)[1]
        commands = re.search(r"^\.SH COMMANDS\n(.*?)^\.PP", page, re.M | re.S)[1]
        self.assertEqual(sorted(re.findall(r"^\.B (\w+)", commands, re.M)), sorted(re.findall(r"^  (\w+)  ", told, re.M)))

    def test_the_version_stands_in_one_place(self):
        files = run("git", "-C", ROOT, "grep", "-lF", VERSION, "--", "*.cc", "*.h", "*.cmake", "*.in", "*.txt", "*.json", "*.yaml", "*.yml",
                    "*.md", "docker", "truestep", ":!web/package-lock.json", ":!tests").split()
        self.assertEqual(files, ["CHANGELOG.md", "CMakeLists.txt"])

    def test_licences_come_along(self):
        documents = self.install("program") / "share/doc/truestep"
        for name in ("LICENSE", "NOTICE", "copyright", "CHANGELOG.md"):
            self.assertGreater((documents / name).stat().st_size, 300, name)

    def test_runtime_packages_are_those_that_are_loaded(self):
        loaded, listed = loaded_packages(BUILD / "bin/truestep"), set(runtime_packages())
        # These come with libstdc++6. OSMesa is opened when a picture is asked for; fmt is spdlog's.
        self.assertEqual(loaded - listed, {"libc6", "libgcc-s1"})
        self.assertLessEqual(listed - loaded, {"libosmesa6", "libfmt9"})


class DebianPackage(Folder):
    def test_it_is_whole_and_runs(self):
        run("cpack", "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", self.folder)
        architecture = run("dpkg", "--print-architecture").strip()
        package = self.folder / f"truestep_{VERSION}_{architecture}.deb"
        self.assertEqual(run("dpkg-deb", "-f", package, "Package", "Version").split(), ["Package:", "truestep", "Version:", VERSION])
        self.assertEqual(run("dpkg-deb", "-f", package, "Depends").strip().split(", "), runtime_packages())
        run("dpkg", "-x", package, self.folder / "root")
        program = self.folder / "root/usr/bin/truestep"
        self.assertEqual(run(program, "--version", cwd=self.folder).strip(), VERSION)
        self.assertIn("hanging_cloth", run(program, "gallery", cwd=self.folder))
        holds = {str(p.relative_to(self.folder / "root")) for p in (self.folder / "root").rglob("*") if p.is_file()}
        documents = {f"usr/share/doc/truestep/{name}" for name in ("LICENSE", "NOTICE", "copyright", "CHANGELOG.md")}
        self.assertEqual(holds, {"usr/bin/truestep", "usr/share/man/man1/truestep.1"} | documents)


if __name__ == "__main__":
    unittest.main()
