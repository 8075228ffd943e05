"""How long a test waits before it calls something hung. Limits in tests are for hangs only: `./truestep test` measures how
slow the machine is at the moment (tests/slowdown.py) and TRUESTEP_SLOWDOWN says so here."""
import os


def patience(seconds):
    """`seconds` on an idle machine, as many more as this one needs."""
    return seconds * max(4.0, float(os.environ.get("TRUESTEP_SLOWDOWN", "4")))
