#!/usr/bin/env python3
"""scripts/tidy.py in a small repository of its own."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
GOOD = "#include \"b.h\"\nint* p = nullptr;\n"
BAD = "int* q = 0;\n"


@unittest.skipUnless(shutil.which("clang-tidy") and shutil.which("clang++"), "no clang-tidy")
class Tidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def repository(self, name, files):
        root = self.folder / name
        for path, text in {".clang-tidy": "Checks: '-*,modernize-use-nullptr'\n"
                                          "WarningsAsErrors: '*'\nHeaderFilterRegex: '.*'\n",
                           **files}.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text)
        shutil.copytree(SCRIPTS, root / "scripts", dirs_exist_ok=True)
        (root / "build/tidy").mkdir(parents=True, exist_ok=True)
        (root / "build/tidy/compile_commands.json").write_text(json.dumps([
            {"directory": str(root), "file": str(root / path),
             "command": f"clang++ -I{root} -I{root}/src -o x.o -c {root}/{path}"}
            for path in files if path.endswith(".cc")]))
        return root

    def tidy(self, root, *seconds):
        """Whether all is well, and how many files were looked at."""
        done = subprocess.run([root / "scripts/tidy.py", root / "build/tidy", "", *seconds],
                              capture_output=True, text=True,
                              env={**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")})
        self.assertEqual(done.stderr, "")
        self.found = done.stdout
        return done.returncode == 0, int(done.stdout.splitlines()[-1].split()[3])

    def test_looks_once_at_what_is_good_and_always_at_what_is_not(self):
        root = self.repository("one", {"src/a.cc": GOOD, "src/b.h": "", "src/c.cc": BAD})
        self.assertEqual(self.tidy(root), (False, 2))
        self.assertIn("c.cc:1:10: error: use nullptr", self.found)
        self.assertEqual(self.tidy(root), (False, 1))
        self.assertIn("c.cc:1:10: error: use nullptr", self.found)
        (root / "src/c.cc").write_text("int* q = 0;  // NOLINT\n")
        self.assertEqual(self.tidy(root), (True, 1))
        self.assertEqual(self.tidy(root), (True, 0))

    def test_begins_with_no_file_when_time_is_over_and_says_so(self):
        root = self.repository("one", {"src/b.h": "", "src/c.cc": BAD})
        self.assertEqual(self.tidy(root, "0"), (True, 0))
        self.assertIn("; 1 are left to scripts/nightly.sh", self.found)
        self.assertEqual(self.tidy(root, "600"), (False, 1))

    def test_another_checkout_has_what_one_has_seen(self):
        files = {"src/a.cc": GOOD, "src/b.h": ""}
        self.assertEqual(self.tidy(self.repository("one", files)), (True, 1))
        self.assertEqual(self.tidy(self.repository("two", files)), (True, 0))

    def test_heeds_what_is_included_comments_and_settings(self):
        files = {"src/a.cc": GOOD, "src/b.h": "inline int* r = 0;  // NOLINT\n"}
        root = self.repository("one", files)
        self.assertEqual(self.tidy(root), (True, 1))
        (root / "src/b.h").write_text("inline int* r = 0;\n")
        self.assertEqual(self.tidy(root), (False, 1))
        (root / "src/b.h").write_text(files["src/b.h"])
        self.assertEqual(self.tidy(root), (True, 0))
        (root / "src/b.h").write_text("#define B(x) x * x\n" + files["src/b.h"])
        self.assertEqual(self.tidy(root), (True, 1))
        settings = root / ".clang-tidy"
        settings.write_text(settings.read_text().replace("nullptr", "nullptr,modernize-use-auto"))
        self.assertEqual(self.tidy(root), (True, 1))
        nearer = "Checks: 'modernize-use-using'\nInheritParentConfig: true\n"
        (root / "src/.clang-tidy").write_text(nearer)
        self.assertEqual(self.tidy(root), (True, 1))

    def test_says_what_does_not_compile(self):
        root = self.repository("one", {"src/a.cc": '#include "none.h"\n'})
        self.assertEqual(self.tidy(root), (False, 1))
        self.assertIn("none.h", self.found)


if __name__ == "__main__":
    unittest.main()
