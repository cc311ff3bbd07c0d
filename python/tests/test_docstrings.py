# SPDX-License-Identifier: Apache-2.0
"""Every public function and class says what it does, with an example that runs."""
import doctest
import importlib
import inspect
import pathlib
import pkgutil
import unittest

import imukit


def modules():
    return [imukit, *(importlib.import_module(f"imukit.{m.name}")
                      for m in pkgutil.iter_modules(imukit.__path__))]


def public(module):
    return {name: getattr(module, name) for name in getattr(module, "__all__", ())}


class Docstrings(unittest.TestCase):
    def test_all_is_said(self):
        for module in modules():
            for name, thing in public(module).items():
                if inspect.ismodule(thing) or isinstance(thing, str):
                    continue
                with self.subTest(f"{module.__name__}.{name}"):
                    self.assertTrue(thing.__doc__, "no docstring")
                    if callable(thing) and not inspect.isclass(thing):
                        self.assertIn(">>>", thing.__doc__, "no example")

    def test_arguments_are_named(self):
        for module in modules():
            for name, thing in public(module).items():
                if not inspect.isfunction(thing):
                    continue
                for argument in inspect.signature(thing).parameters:
                    with self.subTest(f"{module.__name__}.{name}: {argument}"):
                        self.assertIn(argument, thing.__doc__)
                said = thing.__doc__
                if "see help(" in said:  # what all functions of a module have in common
                    said += module.__doc__
                with self.subTest(f"{module.__name__}.{name}"):
                    self.assertIn("Raises", said)
                    self.assertRegex(said, r"Source: |docs/|\[[A-Z]+[0-9]", "no source")

    def test_examples(self):
        for module in modules():
            with self.subTest(module.__name__):
                finder = doctest.DocTestFinder(exclude_empty=True)
                runner = doctest.DocTestRunner(verbose=False)
                for test in finder.find(module, module.__name__.rpartition(".")[2]):
                    runner.run(test)
                self.assertEqual(runner.summarize(verbose=False).failed, 0)


class Typed(unittest.TestCase):
    def test_marked(self):
        folder = pathlib.Path(imukit.__file__).parent
        self.assertTrue((folder / "py.typed").exists())


if __name__ == "__main__":
    unittest.main()
