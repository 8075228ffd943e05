// Nothing: its target compiles tests/pch.h for those of the tests.
