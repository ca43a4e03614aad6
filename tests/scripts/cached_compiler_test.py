#!/usr/bin/env python3
"""scripts/cached_compiler.sh in two checkouts of a small project, with precompiled headers."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/cached_compiler.sh"
FILES = {
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(some LANGUAGES CXX)
add_library(one OBJECT one.cc)
target_precompile_headers(one PRIVATE <vector> ${CMAKE_CURRENT_SOURCE_DIR}/one.h)
add_library(two OBJECT two.cc)
target_precompile_headers(two REUSE_FROM one)
""",
    "one.h": "#define ONE 1\n",
    "one.cc": "std::vector<int> one{ONE};\n",
    "two.cc": "std::vector<int> two{ONE, ONE};\n",
}


@unittest.skipUnless(shutil.which("ccache"), "no ccache")
class CachedCompiler(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="with a space ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def checkout(self, name, changed=None):
        root = self.folder / name
        root.mkdir()
        for path, text in {**FILES, **(changed or {})}.items():
            (root / path).write_text(text)
        (root / "scripts").mkdir()
        shutil.copy(SCRIPT, root / "scripts")
        return root

    @staticmethod
    def configure(root, compiler, environment):
        subprocess.run(["cmake", "-S", root, "-B", root / "build", "-G", "Ninja",
                        f"-DCMAKE_CXX_COMPILER={compiler}",
                        f"-DCMAKE_CXX_COMPILER_LAUNCHER={root}/scripts/cached_compiler.sh"],
                       check=True, capture_output=True, env=environment)

    @staticmethod
    def build(root, environment):
        subprocess.run(["cmake", "--build", root / "build"], check=True, capture_output=True,
                       env=environment)

    def built(self, root, compiler):
        """The number of the two objects that ccache had when all was built."""
        environment = {**os.environ, "CCACHE_DIR": str(self.folder / "cache")}
        self.configure(root, compiler, environment)
        # Hits of what CMake tried above do not count.
        subprocess.run(["ccache", "--zero-stats"], check=True, capture_output=True,
                       env=environment)
        self.build(root, environment)
        printed = subprocess.run(["ccache", "--print-stats"], check=True, capture_output=True,
                                 text=True, env=environment).stdout
        statistics = dict(line.split("\t") for line in printed.splitlines())
        return int(statistics["direct_cache_hit"]) + int(statistics["preprocessed_cache_hit"])

    def check(self, compiler):
        if not shutil.which(compiler):
            self.skipTest(f"no {compiler}")
        self.assertEqual(self.built(self.checkout("a"), compiler), 0)
        self.assertEqual(self.built(self.checkout("b"), compiler), 2)
        # Precompiled headers count, macros included.
        other = {"one.h": "#define ONE 2\n"}
        self.assertEqual(self.built(self.checkout("c", other), compiler), 0)

    def test_of_gcc(self):
        self.check("g++")

    @unittest.skipUnless(os.environ.get("TRILOBE_ALL_CHOICES"), "nightly, as all choices are")
    def test_of_clang(self):
        self.check("clang++")

    def test_without_a_folder_for_ccache(self):
        """A home that cannot be written to, not even by root."""
        root = self.checkout("a")
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith(("CCACHE_", "XDG_"))}
        environment["HOME"] = "/proc/nowhere"
        self.configure(root, "g++", environment)
        self.build(root, environment)


if __name__ == "__main__":
    unittest.main()
