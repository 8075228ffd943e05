#!/usr/bin/env python3
"""Checks the house rules: order of includes and calls, one definition a type, file and folder sizes, head comments, flags, casts, names of one file, choices of the build, controls of scene tests, libm imports, README's folder table.

check.py [--build DIR] [--in PATH...] [RULE...]     prints one line per finding, exit code 1 when one is no warning.
Without a build folder the rules that read object files are left out (the pre-commit hook does that).
"""
import argparse
import sys
from pathlib import Path

import anonymous
import choices
import controls
import files
import includes
import names
import symbols
from source import Tree

RULES = {
    "includes": includes.check,
    "names": names.check,
    "length": files.check_length,
    "head": files.check_head,
    "crowd": files.check_folder_size,
    "machine": files.check_machine_paths,
    "folders": files.check_folder_table,
    "flags": files.check_flags,
    "casts": files.check_casts,
    "anonymous": anonymous.check,
    "choices": choices.check,
    "controls": controls.check,
    "libm": symbols.check,
    "calls": symbols.check_calls,
}


def run(tree, names):
    return [finding for name in names for finding in RULES[name](tree)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rules", nargs="*", metavar="RULE", help=f"of {', '.join(RULES)} (default: all)")
    parser.add_argument("--build", type=Path, help="build folder, for the rules that read object files")
    parser.add_argument("--in", dest="only", metavar="PATH", action="append", help="only findings in this file (repeatable)")
    options = parser.parse_args()
    if unknown := set(options.rules) - set(RULES):
        parser.error(f"unknown rules: {', '.join(sorted(unknown))}")
    tree = Tree(Path(__file__).resolve().parents[2], options.build and options.build.resolve())
    findings = [f for f in run(tree, options.rules or RULES) if not options.only or f.path in options.only]
    for finding in findings:
        print(finding)
    errors = sum(not f.warning for f in findings)
    print(f"{errors} errors, {len(findings) - errors} warnings in {len(tree.paths)} files")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
