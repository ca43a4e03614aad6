#!/usr/bin/env python3
"""Tests of the progress that scripts/setup.sh prints, and of the arguments of ./check."""

import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def said(*lines, passed_on=False):
    """Messages of tell_progress while a build or a test prints these lines, or what it passes on of them."""
    script = ("source scripts/setup.sh; progress_seconds=0; "
              "tell_progress printf '%s\\n' \"$@\" " + ("3>/dev/null" if passed_on else "3>&1 >/dev/null"))
    return subprocess.run(["bash", "-c", script, "bash", *lines], cwd=ROOT, check=True,
                          capture_output=True, text=True).stdout


class Progress(unittest.TestCase):
    def test_of_a_build_is_steps_and_time(self):
        self.assertRegex(said("[1/2] Building CXX object a.o"),
                         r"^==> \[\d+:\d\d\] 1 of 2 done; at this pace \d s to go\n")

    def test_of_tests_is_no_time(self):
        self.assertRegex(said("  1/20 Test  #7: faults ....   Passed   90.05 sec"),
                         r"^==> \[\d+:\d\d\] 1 of 20 done\n")

    def test_of_packages_is_a_share(self):
        of_apt = ["dlstatus:1:40.5:Retrieving file 1 of 2", "pmstatus:libfoo-dev:7.1429:Unpacking libfoo-dev (amd64)"]
        self.assertRegex(said(of_apt[0]), r"^==> \[\d+:\d\d\] 40 % downloaded\n")
        self.assertRegex(said(of_apt[1]), r"^==> \[\d+:\d\d\] 7 % installed\n")
        self.assertEqual(said(of_apt[0], "Get:1 libfoo-dev", of_apt[1], passed_on=True), "Get:1 libfoo-dev\n")


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
