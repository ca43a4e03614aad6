#!/usr/bin/env python3
"""Tests of the progress that scripts/setup.sh prints, and of the arguments of ./check and ./run."""

import os
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


class Script(unittest.TestCase):
    """A script in a folder where scripts/setup.sh only says that the script has begun to set up."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for script in "check", "run":
            shutil.copy(ROOT / script, self.root)
        self.write("scripts/setup.sh", "begin_setup() { exit 7; }\n")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def call(self, script, *arguments):
        return subprocess.run([self.root / script, *arguments], capture_output=True, text=True, check=False)


class Check(Script):
    def test_tells_its_usage_and_does_nothing(self):
        for arguments, status in ((["--help"], 0), (["--verbose"], 1), (["a", "b"], 1)):
            done = self.call("check", *arguments)
            self.assertEqual(done.returncode, status)
            self.assertRegex(done.stdout, r"^usage: \./check\n[^\n]+\n$")
        self.assertEqual(self.call("check").returncode, 7)


class Run(Script):
    def setUp(self):
        super().setUp()
        for name in "src/app/fit_command.cc", "src/app/view_command.cc", "include/a.h", "cmake/a.cmake", "materials/a":
            self.write(name, "")
        self.write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(trilobe VERSION 1.2.3 LANGUAGES CXX)\n")

    def test_answers_without_a_build(self):
        for argument in "--help", "-h", "-help", "--help=fit":
            done = self.call("run", argument)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertRegex(done.stdout, r"(?s)^usage: \./run .*fit, view, help\. `\./run help`")
        done = self.call("run", "--version")
        self.assertEqual((done.returncode, done.stdout), (0, "trilobe version 1.2.3\n"))
        for arguments in ["fitt", "x"], ["fitt", "--help"], ["help", "fitt"]:
            done = self.call("run", *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr),
                             (1, "", "trilobe: error: unknown command 'fitt'; known: fit, view, help\n"))

    def test_builds_for_all_else(self):
        for arguments in [], ["help"], ["help", "fit"], ["fit", "x"], ["view", "--help"], ["--max_angle=75", "fit"]:
            self.assertEqual(self.call("run", *arguments).returncode, 7)

    def test_lets_a_program_answer_that_is_up_to_date(self):
        program = self.program()
        for arguments in ["--help"], ["--version"], ["fitt", "x"], ["help"], ["help", "fitt"], ["fit", "--help"]:
            done = self.call("run", *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (5, f"program {' '.join(arguments)}\n", ""))
        os.utime(self.root / "include/a.h", (program.stat().st_mtime + 1,) * 2)
        self.assertEqual(self.call("run", "--version").stdout, "trilobe version 1.2.3\n")

    def test_asks_an_older_program_for_help_and_says_so(self):
        os.utime(self.root / "include/a.h", (self.program().stat().st_mtime + 1,) * 2)
        for arguments in ["help"], ["help", "fit"], ["help", "--man"], ["fit", "x", "--help"], ["fit", "-h"]:
            done = self.call("run", *arguments)
            self.assertEqual((done.returncode, done.stdout), (5, f"program {' '.join(arguments)}\n"))
            self.assertRegex(done.stderr, r"^trilobe: help of a program that is older [^\n]+\n$")
        for arguments in [], ["fit", "x"], ["fit", "x--help"]:
            self.assertEqual(self.call("run", *arguments).returncode, 7)

    def program(self):
        path = self.write("build/release/bin/trilobe", "#!/bin/sh\necho program \"$@\"\nexit 5\n")
        path.chmod(0o755)
        return path


if __name__ == "__main__":
    unittest.main()
