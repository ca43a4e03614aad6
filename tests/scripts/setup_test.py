#!/usr/bin/env python3
"""Tests of the progress that scripts/setup.sh prints, and of the arguments of ./check."""

import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def said(*lines):
    """Messages of tell_progress while a build or a test prints these lines."""
    script = ("source scripts/setup.sh; progress_seconds=0; "
              "tell_progress printf '%s\\n' \"$@\" 3>&1 >/dev/null")
    return subprocess.run(["bash", "-c", script, "bash", *lines], cwd=ROOT, check=True,
                          capture_output=True, text=True).stdout


class Progress(unittest.TestCase):
    def test_of_a_build_is_steps_and_time(self):
        self.assertRegex(said("[1/2] Building CXX object a.o"),
                         r"^==> \[\d+:\d\d\] 1 of 2 done; at this pace \d s to go\n")

    def test_of_tests_is_no_time(self):
        self.assertRegex(said("  1/20 Test  #7: faults ....   Passed   90.05 sec"),
                         r"^==> \[\d+:\d\d\] 1 of 20 done\n")


class Check(unittest.TestCase):
    def check(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            shutil.copy(ROOT / "check", root)
            (root / "scripts").mkdir()
            (root / "scripts/setup.sh").write_text("exit 7  # it has begun\n")
            return subprocess.run([root / "check", *arguments], capture_output=True, text=True,
                                  check=False)

    def test_tells_its_usage_and_does_nothing(self):
        for arguments, status in ((["--help"], 0), (["--verbose"], 1), (["a", "b"], 1)):
            done = self.check(*arguments)
            self.assertEqual(done.returncode, status)
            self.assertRegex(done.stdout, r"^usage: \./check\n[^\n]+\n$")
        self.assertEqual(self.check().returncode, 7)


if __name__ == "__main__":
    unittest.main()
