#!/usr/bin/env python3
"""scripts/check_figures.py in a small repository of its own."""

import json
import pathlib
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check_figures.py"
DEBIAN = pathlib.Path("/usr/bin/python3")  # the one that has the packages
HAS_PACKAGES = DEBIAN.exists() and subprocess.run(
    [DEBIAN, "-c", "import numpy"], capture_output=True, check=False).returncode == 0
TABLE = """material,fit,psnr_db,seconds
a,auto,40.04,2
b,auto,42,
a,lm,39.5,4
b,lm,43.6,5
"""


@unittest.skipUnless(HAS_PACKAGES, "no numpy")
class CheckFigures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.results = self.root / "experiments/x/results"
        self.results.mkdir(parents=True)
        (self.root / "src/fit").mkdir(parents=True)
        (self.root / "src/fit/fit.cc").write_text("1\n")
        (self.root / "experiments/same_fits.txt").write_text("# none\n")
        (self.root / "experiments/x/manifest.json").write_text('{"flags": {"raw": true}, "quick": {}}')
        (self.results / "table.csv").write_text(TABLE)
        self.git("init", "--quiet")
        self.commit()
        self.manifest()

    def git(self, *arguments):
        identity = ["-c", "user.name=a", "-c", "user.email=a@b"]
        return subprocess.run(["git", *identity, *arguments], cwd=self.root, capture_output=True, text=True,
                              check=True).stdout.strip()

    def commit(self):
        self.git("add", ".")
        self.git("commit", "--quiet", "--message=x")

    def manifest(self, revision="", flags=None):
        revision = revision or self.git("rev-parse", "--short", "HEAD")
        (self.results / "manifest.json").write_text(json.dumps(
            {"form": "full", "settings": {"flags": flags or {"raw": True}}, "tabulated_at": revision,
             "programs": [{"name": "p", "revision": revision}]}))

    def page(self, bound, text, before="# Title\n\n", after="", begins=""):
        """A page whose paragraph, the text, has figures; `bound` is SOURCE; FIGURE = WHERE; ..."""
        (self.root / "docs").mkdir(exist_ok=True)
        (self.root / "README.md").write_text(f"{before}{text}\n\n{after}")
        source, *figures = bound.split("; ")
        (self.root / "docs/figures.txt").write_text("\n".join(
            ["# of a page", "", f"../README.md: {begins or text.splitlines()[0]}", f"  {source}",
             *(f"    {figure}" for figure in figures), ""]))

    def check(self, *options):
        done = subprocess.run([SCRIPT, f"--root={self.root}", *options], capture_output=True, text=True, check=False)
        self.output = done.stdout + done.stderr
        return done.returncode == 0

    def holds(self, bound, text, **around):
        self.page(bound, text, **around)
        return self.check()

    def of_table(self, figure, where):
        return self.holds(f"../experiments/x/results/table.csv; {figure} = {where}", f"It is {figure}.")

    def test_what_a_command_prints(self):
        echo = "echo 'E is 0.0406 %, PSNR 47.1 dB, PSNR 46.6 dB'"
        self.assertTrue(self.holds(echo + "; 46.6 dB = PSNR; 0.041 % = E is", "46.6\ndB, E is 0.041 %."), self.output)
        self.assertTrue(self.holds(echo + "; 47 dB = PSNR", "47 dB"), self.output)
        self.assertTrue(self.holds(echo + "; 47.1 dB = is .*? PSNR (\\S+) dB, ", "47.1 dB"), self.output)
        self.assertTrue(self.holds(echo + "; 46.7 dB = PSNR", "46.7 dB"), self.output)  # a last digit
        self.assertFalse(self.holds(echo + "; 46.8 dB = PSNR", "46.8 dB"))
        self.assertIn("46.8 dB is 46.6", self.output)
        self.assertFalse(self.holds(echo + "; 46.6 dB = SSIM", "46.6 dB"))
        self.assertIn("SSIM is not printed", self.output)
        self.assertFalse(self.holds("false; 46.6 dB = PSNR", "46.6 dB"))
        self.assertIn("`false` fails", self.output)

    def test_what_it_leaves_in_a_file(self):
        command = """echo '{"a": [{"share": 0.0123}]}' > b.json"""
        self.assertTrue(self.holds(command + "; 1.2 % = b.json a.0.share", "1.2 %"), self.output)
        self.assertFalse(self.holds(command + "; 1.5 % = b.json a.0.share", "1.5 %"))
        self.assertFalse(self.holds(command + "; 1.2 % = b.json a.1.share", "1.2 %"))

    def test_the_block_above_or_below(self):
        program = self.root / "build/release/bin/trilobe"
        program.parent.mkdir(parents=True)
        program.write_text("#!/bin/sh\necho \"$# arguments\"\n")
        program.chmod(0o755)
        below = "```sh\ntrilobe fit a\n```\n"
        self.assertTrue(self.holds("below; 2 = ^", "2", after=below), self.output)
        self.assertTrue(self.holds("below --b --c; 4 = ^", "four is 4", after=below), self.output)
        self.assertTrue(self.holds("above; three = ^", "Three", before="# T\n\n    trilobe fit a \\\n        b\n\n"),
                        self.output)
        self.assertFalse(self.holds("above; 2 = ^", "2", after=below))
        self.assertIn("no block of commands above", self.output)

    def test_nightly_and_measured_files(self):
        self.page("nightly: false; 1 = a", "1")
        self.assertTrue(self.check("--quick"), self.output)
        self.assertTrue(self.check("--tables"), self.output)
        self.assertFalse(self.check())
        self.page("cat steel.binary; 1 = a", "1")
        self.assertTrue(self.check())
        self.assertIn("not checked: 1 figures of `cat steel.binary` (steel.binary", self.output)
        (self.root / "data/merl").mkdir(parents=True)
        (self.root / "data/merl/steel.binary").write_text("a 2")
        self.assertTrue(self.check(f"--data={self.root / 'data'}"), self.output)  # 1 off the last digit
        self.page("cat steel.binary; 4 = a", "4")
        self.assertFalse(self.check(f"--data={self.root / 'data'}"))

    def test_a_figure_stands_in_its_paragraph(self):
        self.assertFalse(self.holds("echo a 6; 6 dB = a", "46.6 dB"))
        self.assertIn("no `6 dB` stands in `46.6 dB`", self.output)
        self.assertFalse(self.holds("echo a 6, 6 = a", "6"))
        self.assertIn("binds no figure", self.output)
        self.assertFalse(self.holds("echo a 46; 46 = a", "46.6 dB, or 146"))
        self.assertFalse(self.holds("echo a 6; 6 dB = a", "A\n\n6 dB"))
        self.assertTrue(self.holds("echo a 6; 6 dB = a", "```text\n\n6 dB\n```"), self.output)

    def test_a_paragraph_is_found_by_its_beginning(self):
        echo = "echo a 6; 6 = a"
        self.assertTrue(self.holds(echo, "One\ntwo  three: 6", begins="One two three"), self.output)
        self.assertTrue(self.holds(echo, "- 5\n- an item of 6", begins="- an item"), self.output)
        self.assertFalse(self.holds(echo, "It is 6", begins="is 6"))
        self.assertIn("no paragraphs begin with `is 6`", self.output)
        self.assertFalse(self.holds(echo, "It is 6", after="It is", begins="It is"))
        self.assertIn("2 paragraphs begin with `It is`", self.output)
        self.assertTrue(self.holds(echo, "It is 6", after="<!--\nIt is -->\n", begins="It is"), self.output)
        (self.root / "README.md").unlink()
        self.assertFalse(self.check())
        self.assertIn("README.md: is bound, but does not exist", self.output)

    def test_a_file_that_cannot_be_read(self):
        self.page("echo", "It is 6")
        file = self.root / "docs/figures.txt"
        for text, why in [("README.md\n", "names no page and paragraph"), ("  echo a\n", "stands below no paragraph"),
                          ("../README.md: It is\n    6 = a\n", "stands below no source")]:
            file.write_text(text)
            self.assertFalse(self.check())
            self.assertIn(f"docs/figures.txt: `{text.splitlines()[-1]}` {why}", self.output)
        file.write_text("../README.md: It\n  echo\n      a 6\n    6 =\n      a\n")
        self.assertTrue(self.check(), self.output)

    def test_an_experiment_binds_figures_of_its_page(self):
        (self.root / "experiments/x/README.md").write_text("# X\n\nIt is 43.6\n")
        file = self.root / "experiments/x/figures.txt"
        for figure, holds in [("43.6", True), ("43.5", False)]:
            (self.root / "experiments/x/README.md").write_text(f"# X\n\nIt is {figure}\n")
            file.write_text(f"README.md: It is\n  results/table.csv\n    {figure} = max(psnr_db)\n")
            self.assertEqual(self.check(), holds, self.output)

    def test_statistics_of_a_table(self):
        for figure, where in [("40.0 dB", 'psnr_db[(material == "a") & (fit == "auto")][0]'),
                              ("four", "count(psnr_db > 1)"), ("25 %", "share(psnr_db > 43)"), ("5", "max(seconds)"),
                              ("−1", 'min(each(material, max, psnr_db)) - 41.04'), ("1.01", "43.6 / 43.2"),
                              ("2", 'count(each(material, min, psnr_db) > 39)'), ("39.5", "quantile(psnr_db, 0.25)")]:
            self.assertTrue(self.of_table(figure, where), self.output)
        self.assertFalse(self.of_table("40.1 dB", 'psnr_db[0]'))  # it is rounded: no other last digit
        self.assertIn("40.1 dB is 40.0", self.output)
        self.assertFalse(self.of_table("40.0 dB", "ssim[0]"))
        self.assertFalse(self.of_table("40.0 dB", "open"))

    def test_a_table_in_markdown(self):
        (self.results / "table.md").write_text(
            "| of | E above, % | PSNR, dB |\n| --- | --- |\n| 1 a | **1.53** [0, 2] | 40 |\n| 2 b | – | – |\n")
        for figure, where in [("1.5 %", 'E_above[of == "1 a"][0]'), ("40", "max(PSNR_dB)")]:
            self.assertTrue(self.holds(f"../experiments/x/results/table.md; {figure} = {where}", figure), self.output)
        self.assertFalse(self.holds("../experiments/x/results/table.md; 1.6 % = max(E_above)", "1.6 %"))

    def test_a_page_of_stale_tables_says_so(self):
        page = self.root / "experiments/x/README.md"
        page.write_text("# X\n\nText\n")
        self.assertTrue(self.check(), self.output)
        for revision, flags, why in [("0123abc-dirty", None, "not in this repository (0123abc-dirty)"),
                                     ("", {"raw": False}, "other settings")]:
            self.manifest(revision, flags)
            self.assertFalse(self.check())
            self.assertIn("--write", self.output)
            self.assertTrue(self.check("--write"), self.output)
            self.assertIn(why, page.read_text().split("\n\n")[1])
            self.assertTrue(self.check(), self.output)
        self.manifest()
        self.assertFalse(self.check())
        self.assertTrue(self.check("--write"), self.output)
        self.assertEqual(page.read_text(), "# X\n\nText\n")
        (self.root / "src/fit/fit.cc").write_text("2\n")
        self.assertFalse(self.check())
        self.assertIn("before changes of fits", self.output)
        self.commit()
        self.assertFalse(self.check())
        same = self.root / "experiments/same_fits.txt"
        head = self.git("rev-parse", "--short", "HEAD")
        for line, is_same in [("looked at", True), ("but y x: looked at", False), ("but y: looked at x", True)]:
            same.write_text(f"{head} {line}\n")
            self.assertEqual(self.check(), is_same, self.output)

    def test_another_page_names_the_stale_experiments(self):
        self.manifest("0123abc")
        page = self.root / "README.md"
        self.assertFalse(self.of_table("43.6", "max(psnr_db)"))
        self.assertTrue(self.check("--write"), self.output)
        self.assertIn("> **Stale:** see the pages of x.", page.read_text())
        self.assertTrue(self.check(), self.output)


if __name__ == "__main__":
    unittest.main()
