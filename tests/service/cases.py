"""What the tests of the running service share: a scene and a class that starts the service once."""
import unittest

from harness import Service

OSCILLATOR = {"name": "one mass", "time": {"dt": 0.01, "duration": 1},
              "systems": [{"type": "oscillator", "id": "a", "stiffness": 100, "damping": 2, "position": 1}],
              "observables": ["energy"]}


class Case(unittest.TestCase):
    options = ()

    @classmethod
    def setUpClass(cls):
        cls.service = Service(*cls.options)

    @classmethod
    def tearDownClass(cls):
        assert cls.service.stop() == 0
