"""Shared helpers of the tests."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile
import unittest

EXPERIMENTS = pathlib.Path(__file__).resolve().parents[2]


class FolderTest(unittest.TestCase):
    """A test with a folder of its own, self.folder."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)


def load(folder, name):
    """A program or module of an experiment, as a module."""
    sys.path.insert(0, str(EXPERIMENTS / folder))
    try:
        loader = importlib.machinery.SourceFileLoader(f"{folder}_{name}",
                                                      str(EXPERIMENTS / folder / name))
        module = importlib.util.module_from_spec(
            importlib.util.spec_from_loader(loader.name, loader))
        loader.exec_module(module)
    finally:
        sys.path.remove(str(EXPERIMENTS / folder))
    return module
