"""The controls of the service's tests: each of them, given a wrong answer (alterations.py), must fail.

One service serves them all, and each test runs once more with its answers altered on the way to it.
"""
import importlib
import subprocess
import unittest
from unittest import mock

from alterations import ALTERED
from harness import Service, Socket


def altered(alteration):
    """Patches under which a test sees the wrong answer."""
    kind, which, change = alteration
    request, receive, start, run = Service.request, Socket.message, Socket.__init__, subprocess.run

    def http(self, method, path, *rest):
        a = request(self, method, path, *rest)
        if kind == "http" and which.search(method + " " + path):
            change(a)
        return a

    def stream(self, wanted):
        m = receive(self, wanted)
        if kind == "stream" and wanted == which:
            change(m)
        return m

    def handshake(self, *arguments):
        start(self, *arguments)
        if kind == "handshake":
            self.status = change

    def program(*arguments, **options):
        done = run(*arguments, **options)
        if kind == "program":
            change(done)
        return done

    return (mock.patch.object(Service, "request", http), mock.patch.object(Socket, "message", stream),
            mock.patch.object(Socket, "__init__", handshake), mock.patch.object(subprocess, "run", program))


class Controls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.service = Service()

    @classmethod
    def tearDownClass(cls):
        cls.service.stop()

    def run_one(self, case, name, alteration):
        """What the test's assertion said, "" when it passed; an exception of any other kind is no verdict."""
        test = case(name)
        case.service = self.service
        result = unittest.TestResult()
        patches = altered(alteration)
        for patch in patches:
            patch.start()
        try:
            # The test itself and its clean-up; the class's own service is not started.
            test.run(result)
        finally:
            for patch in patches:
                patch.stop()
        self.assertEqual(result.errors, [])
        return result.failures[0][1] if result.failures else ""


def add(module, case_name, case):
    tests = unittest.TestLoader().getTestCaseNames(case)

    def every_test_has_one(self):
        self.assertEqual(set(tests), set(ALTERED[module + "." + case_name]))

    setattr(Controls, "test_every_test_of_%s_has_one" % case_name, every_test_has_one)
    for name in tests:
        def control(self, name=name):
            for alteration in ALTERED[module + "." + case_name][name]:
                self.assertTrue(self.run_one(case, name, alteration), "passes with a wrong answer")
        setattr(Controls, "test_%s_%s" % (case_name, name[5:]), control)


for path in ALTERED:
    module_name, class_name = path.split(".")
    add(module_name, class_name, getattr(importlib.import_module(module_name), class_name))


if __name__ == "__main__":
    unittest.main()
