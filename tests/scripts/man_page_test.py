#!/usr/bin/env python3
"""Tests of the manual that `trilobe help --man` writes, by the program that TRILOBE_PROGRAM names."""

import os
import re
import shutil
import subprocess
import sys
import unittest

PROGRAM = os.environ.get("TRILOBE_PROGRAM", "")


def output_of(*command, text=""):
    done = subprocess.run(command, check=True, capture_output=True, text=True, input=text)
    return done.stdout, done.stderr


def words(text):
    """Those of a text, whatever its lines; `commands` are bold in the manual."""
    return " ".join(text.replace("`", "").split())


@unittest.skipUnless(PROGRAM, "no program to ask")
class ManPage(unittest.TestCase):
    def setUp(self):
        self.page = output_of(PROGRAM, "help", "--man")[0]

    def test_is_escaped(self):
        self.assertTrue(self.page.isascii())
        self.assertNotRegex(re.sub(r'(?m)^\.TH .*$', "", self.page), r"[\"'`^~]|(?<!\\)-")
        for line in self.page.splitlines():
            self.assertEqual(len(re.findall(r"\\f[BI]", line)) > 0, "\\fR" in line, line)
            self.assertNotIn(r"\fB\fR", line)
            self.assertRegex(line, r"^(\.(TH|SH|SS|PP|TP|IP|nh|ad|br|B|I)\b|[^.'])")

    @unittest.skipUnless(shutil.which("groff"), "no groff to lay it out with")
    def test_is_laid_out_without_warnings_and_has_all_of_help(self):
        for columns in 60, 80, 100:
            shown, warnings = output_of("groff", "-man", "-Tutf8", "-ww", "-P-cbou", f"-rLL={columns}n",
                                        text=self.page)
            self.assertEqual(warnings, "")
        commands = re.findall(r"(?m)^  ([a-z]+)  ", output_of(PROGRAM, "help")[0])
        self.assertIn("fit", commands)
        for command in commands:
            if command == "help":
                continue
            self.assertRegex(shown, rf"(?m)^   {command}$")
            told = output_of(PROGRAM, "help", command)[0]
            for flag in re.findall(r"(?m)^  (--\w+=.*)$", told):
                self.assertIn(f"\n       {flag}\n", shown)
            self.assertIn(words(told.replace("usage: ", "")), words(shown))


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped else 0)
