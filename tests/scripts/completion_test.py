#!/usr/bin/env python3
"""Tests of scripts/trilobe.bash, against the program that TRILOBE_PROGRAM names."""

import os
import pathlib
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("TRILOBE_PROGRAM", "")


def proposed(*words):
    """What bash proposes for the last word; bash takes --solver=awls for three."""
    script = ("source scripts/trilobe.bash; compopt() { :; }; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); "
              "_trilobe; printf '%s\\n' \"${COMPREPLY[@]}\"")
    done = subprocess.run(["bash", "-c", script, "bash", PROGRAM, *words], cwd=ROOT, check=True,
                          capture_output=True, text=True)
    return set(done.stdout.split())


@unittest.skipUnless(PROGRAM, "no program to ask")
class Completion(unittest.TestCase):
    def test_commands(self):
        self.assertEqual(proposed("co"), {"compare", "convert"})
        self.assertEqual(proposed("help", "co"), {"compare", "convert"})

    def test_flags(self):
        self.assertIn("--solver=", proposed("fit", "--so"))
        self.assertIn("--dark_noise=", proposed("fit", "--d"))  # a rare one
        self.assertEqual(proposed("synth", "--solver"), set())

    def test_values(self):
        self.assertIn("awls_gss", proposed("fit", "--solver", "=", "aw"))
        self.assertNotIn("lm", proposed("fit", "--solver", "=", "aw"))
        self.assertIn("lm", proposed("fit", "--solver", "="))

    def test_files(self):
        self.assertIn("README.md", proposed("fit", "READ"))


if __name__ == "__main__":
    unittest.main()
