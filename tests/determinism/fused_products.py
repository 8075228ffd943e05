#!/usr/bin/env python3
"""fused_products.py ARCHIVE [--allow OBJECT ...]: no compiler has fused a product with a sum and a difference on its own.
GCC 12 turns (a b - c, a b + c) into vfmaddsub when it vectorises straight-line code, whatever -ffp-contract says, and the
result then depends on the optimisation level. In the objects named by --allow the source asks for it: std::fma with
alternating signs, or Eigen's complex packets. Every allowed object must still hold one, which is the control."""
import argparse
import re
import subprocess
import sys


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("archive")
    parser.add_argument("--allow", nargs="*", default=[])
    a = parser.parse_args()
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", a.archive], stdout=subprocess.PIPE, text=True, check=True).stdout
    found, name = {}, ""
    for line in text.splitlines():
        if head := re.match(r"(\S+\.o):\s+file format", line):
            name = head[1]
        elif "vfmaddsub" in line or "vfmsubadd" in line:
            found[name] = found.get(name, 0) + 1
    wrong = {n: k for n, k in found.items() if n not in a.allow}
    gone = [n for n in a.allow if n not in found]
    print("fused without being asked:", wrong or "nothing", "; allowed but absent:", gone or "nothing")
    return 1 if wrong or gone else 0


if __name__ == "__main__":
    sys.exit(main())
