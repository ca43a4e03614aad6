#!/usr/bin/env python3
"""scripts/reached.py in a small repository of its own."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/reached.py"
FILES = {
    "include/trilobe/base/error.h": "",
    "src/math/cubic.h": '#include "trilobe/base/error.h"\n',
    "src/math/cubic.cc": '#include "math/cubic.h"\n',
    "src/math/stencil.cc": "",
    "tests/util.h": '#include "math/cubic.h"\n',
    "tests/math/cubic_test.cc": '#include "tests/util.h"\n',
    "tests/math/stencil_test.cc": '#include "beside.h"\n',
    "tests/math/beside.h": "",
    "CMakeLists.txt": "",
    "README.md": "",
}
LISTS = """cmake_minimum_required(VERSION 3.25)
project(some LANGUAGES CXX)
add_library(math OBJECT src/math/cubic.cc src/math/stencil.cc)
file(CONFIGURE OUTPUT made.cc CONTENT "int made;")
add_library(made OBJECT made.cc)
"""
PRESETS = {"version": 6, "configurePresets": [{
    "name": "build", "generator": "Ninja", "binaryDir": "${sourceDir}/${presetName}",
    "cacheVariables": {"CMAKE_EXPORT_COMPILE_COMMANDS": "ON"}}]}
SOURCES = [name for name in FILES if name.endswith(".cc")]


class Reached(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        for name, text in FILES.items():
            self.write(name, text)
        (self.root / "scripts").mkdir()
        shutil.copy(SCRIPT, self.root / "scripts")
        commands = [{"directory": str(self.root), "file": name} for name in SOURCES]
        self.write("build/compile_commands.json", json.dumps(commands))
        self.write(".gitignore", "/build/\n")
        self.git("init", "--initial-branch=main")
        self.commit()
        self.git("switch", "--create", "branch")

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def git(self, *arguments, environment=None):
        who = ["-c", "user.name=nobody", "-c", "user.email=nobody@example.org"]
        subprocess.run(["git", *who, *arguments], cwd=self.root, check=True, capture_output=True,
                       env={**os.environ, **(environment or {})})

    def commit(self, date="2026-01-01T12:00:00"):
        self.git("add", "--all")
        self.git("commit", "--message=x", environment={"GIT_COMMITTER_DATE": date})

    def reached(self, base="main"):
        done = subprocess.run([self.root / "scripts/reached.py", "build", base], cwd=self.root,
                              capture_output=True, text=True, check=True)
        return [str(pathlib.Path(line).relative_to(self.root)) for line in done.stdout.split()]

    def test_checks_a_changed_header_by_its_own_source(self):
        self.write("src/math/cubic.h", '#include "trilobe/base/error.h"\n// changed\n')
        self.commit()
        self.assertEqual(self.reached(), ["src/math/cubic.cc"])
        # Even where another source has changed itself.
        self.write("tests/math/cubic_test.cc", '#include "tests/util.h"\n// changed\n')
        self.assertEqual(self.reached(), ["src/math/cubic.cc", "tests/math/cubic_test.cc"])

    def test_checks_a_header_without_a_source_by_what_includes_it(self):
        self.write("include/trilobe/base/error.h", "// changed\n")
        self.commit()
        self.assertEqual(self.reached(), ["src/math/cubic.cc"])
        self.git("branch", "--force", "main")
        self.write("tests/util.h", '#include "math/cubic.h"\n// changed\n')
        self.assertEqual(self.reached(), ["tests/math/cubic_test.cc"])

    def test_checks_all_that_may_have_relied_on_an_include(self):
        self.write("src/math/cubic.h", "")
        self.assertEqual(self.reached(), ["src/math/cubic.cc", "tests/math/cubic_test.cc"])

    def test_sees_what_is_not_committed(self):
        self.write("tests/math/beside.h", "// changed\n")
        self.assertEqual(self.reached(), ["tests/math/stencil_test.cc"])

    def test_sees_new_files(self):
        self.git("rm", "--cached", "src/math/stencil.cc")
        self.git("commit", "--message=x")
        self.git("branch", "--force", "main")
        self.assertEqual(self.reached(), ["src/math/stencil.cc"])

    def test_leaves_out_what_main_has_changed_since(self):
        self.write("README.md", "changed\n")
        self.commit()
        self.git("switch", "main")
        self.write("include/trilobe/base/error.h", "// changed\n")
        self.commit()
        self.git("switch", "branch")
        self.assertEqual(self.reached(), [])

    def test_takes_what_landed_last_where_nothing_has_changed_since(self):
        self.write("include/trilobe/base/error.h", "// changed\n")
        self.commit("2026-01-02T01:00:00")
        self.write("tests/math/beside.h", "// changed\n")
        self.commit("2026-01-02T08:00:00")
        self.write("src/math/stencil.cc", "// changed\n")
        self.commit("2026-01-02T09:30:00")
        self.assertEqual(self.reached("HEAD"), ["src/math/stencil.cc", "tests/math/stencil_test.cc"])

    def test_takes_all_of_a_branch_that_was_merged_last(self):
        self.write("src/math/stencil.cc", "// changed\n")
        self.commit("2026-01-02T00:00:00")
        self.git("switch", "main")
        self.git("merge", "--no-ff", "--message=x", "branch",
                 environment={"GIT_COMMITTER_DATE": "2026-01-02T09:30:00"})
        self.assertEqual(self.reached("HEAD"), ["src/math/stencil.cc"])

    def test_takes_all_where_it_cannot_tell(self):
        self.assertEqual(self.reached(), SOURCES)  # nothing has changed, and nothing is older
        self.write("src/math/stencil.cc", "// changed\n")
        self.assertEqual(self.reached(), ["src/math/stencil.cc"])
        self.assertEqual(self.reached("nowhere"), SOURCES)
        self.assertEqual(self.reached(""), SOURCES)
        self.write(".clang-tidy", "# changed\n")
        self.assertEqual(self.reached(), SOURCES)
        (self.root / ".clang-tidy").unlink()
        self.write("CMakePresets.json", "none\n")
        self.assertEqual(self.reached(), SOURCES)  # there was no preset before

    def test_sees_what_is_compiled_otherwise(self):
        self.git("switch", "main")
        self.write("CMakeLists.txt", LISTS)
        self.write("CMakePresets.json", json.dumps(PRESETS))
        self.commit()
        self.git("switch", "branch")
        self.git("merge", "main")

        def configured(text):
            self.write("CMakeLists.txt", text)
            subprocess.run(["cmake", "--preset", "build"], cwd=self.root, check=True,
                           capture_output=True)
            return self.reached()

        self.assertEqual(configured(LISTS + "# changed\n"), [])
        self.assertEqual(configured(LISTS + "target_compile_definitions(math PRIVATE X)\n"),
                         ["src/math/cubic.cc", "src/math/stencil.cc"])
        self.assertEqual(configured(LISTS.replace("int made", "long made")), ["build/made.cc"])
        self.assertEqual(configured(LISTS + "add_library(more OBJECT tests/math/cubic_test.cc)\n"),
                         ["tests/math/cubic_test.cc"])


unittest.main()
