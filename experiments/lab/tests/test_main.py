"""Tests of the command's results: tables and pictures that are whole, and exit statuses."""
import contextlib
import io
import os
import shutil
import subprocess
import sys
import types
import unittest
import unittest.mock

from lab import UsageError, experiments, main, tables
from lab.experiments import Experiment
from lab.tests import FolderTest
from lab.units import FOLDER, Unit

MANIFEST = '{"question": "?", "flags": {}, "runs": [], "quick": {"sources": ["synth:plastic"]}}'
PUBLISHED = experiments.FOLDER  # that of this repository; the tests put another in its place
PROGRAM = """#!/bin/sh
[ "$2" != bad ] || { echo broken >&2; exit 1; }
echo 1 > "$1/number"
"""


class PublishedTest(FolderTest):
    def test_published_texts_are_those_of_published_tables(self):
        from lab import plots  # here: it takes a second to load
        with unittest.mock.patch.object(plots, "save", lambda figure, _: plots.plt.close(figure)):
            for name in experiments.names():
                experiment = experiments.load(name)
                for published in PUBLISHED.glob(f"{name}/results*"):
                    drawn = self.folder / name / published.name
                    shutil.copytree(published, drawn)
                    main.draw(experiment, drawn)
                    for path in published.glob("*.md"):
                        with self.subTest(path=path):
                            self.assertEqual((drawn / path.name).read_text(), path.read_text())


class MainTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "x").mkdir()
        (self.folder / "x" / "manifest.json").write_text(MANIFEST)
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.words = ["good"]
        self.module = types.SimpleNamespace(units=self.units, tabulate=self.tabulate,
                                            draw=lambda drawn, _: {"text.md": "drawn"})
        folder = experiments.FOLDER
        experiments.FOLDER = self.folder
        self.addCleanup(setattr, experiments, "FOLDER", folder)

    def units(self, _):
        return [Unit(f"of/{word}", self.program, (FOLDER, word), "number",
                     labels={"solver": word}) for word in self.words]

    @staticmethod
    def tabulate(_, results):
        return {"results": [{"solver": result.labels["solver"], "there": int(bool(result.folder))}
                            for result in results]}

    def run_it(self, *options):
        """(exit status, what was said on standard error)"""
        options = main.parse(["x", "--quick", f"--out={self.folder / 'out'}", *options])
        with (contextlib.redirect_stdout(io.StringIO()),
              contextlib.redirect_stderr(io.StringIO()) as said):
            return main.run(Experiment("x", self.module), options), said.getvalue()

    def table(self):
        return tables.read(self.folder / "out" / "x" / "results.csv")

    def test_a_unit_that_fails_is_a_row_and_a_status(self):
        self.words = ["good", "bad"]
        status, said = self.run_it()
        self.assertEqual(status, main.SOME_FAILED)
        self.assertIn("missing: 1 units", said)
        self.assertIn("of/bad: exit status 1: broken", said)
        self.assertEqual([row["there"] for row in self.table()], [1, 0])

    def records(self, *words):
        """(exit status, what was said) of the command `records`."""
        with (contextlib.redirect_stdout(io.StringIO()) as out,
              contextlib.redirect_stderr(io.StringIO()) as said):
            status = main.main(["records", f"--out={self.folder / 'out'}", f"--program={self.program}", *words])
            return status, out.getvalue() + said.getvalue()

    def test_records_takes_folders_of_fits_and_searches_only_when_asked_to(self):
        (self.folder / "empty").mkdir()
        (self.folder / "fits" / "a").mkdir(parents=True)
        (self.folder / "fits" / "a" / "report.json").write_text("{}")  # by another version
        for words, error in ((["--search"], "give BRDF files"), ([str(self.folder / "empty")], "empty holds no fits")):
            status, said = self.records(*words)
            self.assertEqual(status, 2)
            self.assertIn(error, said)
        status, said = self.records(str(self.folder / "fits"))
        self.assertEqual(status, 0, said)

    def test_what_fails_in_drawing_leaves_earlier_tables(self):
        self.assertEqual(self.run_it()[0], 0)
        before = self.table()

        def broken(drawn, folder):
            raise RuntimeError("draw")
        self.module.draw, self.words = broken, ["good", "other"]
        with self.assertRaises(RuntimeError):
            self.run_it()
        self.assertEqual(self.table(), before)
        self.assertEqual({path.name for path in (self.folder / "out").iterdir()}, {"units", "x"})

    def test_a_shard_makes_no_tables(self):
        self.words = ["good", "other"]
        for shard in ("1/2", "2/2"):
            self.assertEqual(self.run_it(f"--shard={shard}")[0], 0)
            self.assertFalse((self.folder / "out" / "x").exists())
        self.assertEqual(self.run_it("--count")[0], 0)
        self.assertEqual(self.run_it("--no-run")[0], 0)
        self.assertEqual([row["there"] for row in self.table()], [1, 1])

    def test_only_a_full_run_is_published_whole(self):
        with self.assertRaisesRegex(UsageError, "no quick form"):
            self.run_it("--publish")
        experiment, out = Experiment("x", self.module), self.folder / "out" / "x"
        self.run_it("--no-run")
        with self.assertRaisesRegex(UsageError, "1 units have not been tried"):
            main.publish(experiment, out)
        self.words = ["good", "bad"]
        self.run_it()
        with contextlib.redirect_stdout(io.StringIO()):
            main.publish(experiment, out)  # failures show in the tables
        self.assertTrue((experiment.published() / "results.csv").exists())

    def test_the_anisotropic_form_is_published_beside_the_full_one(self):
        (self.folder / "x" / "manifest.json").write_text(
            MANIFEST.replace('"quick"', '"anisotropic": {"sources": ["synth:velvet"]}, "quick"'))
        self.run_it("--anisotropic", "--publish")
        experiment = Experiment("x", self.module)
        self.assertTrue((experiment.published("anisotropic") / "results.csv").exists())
        self.assertFalse(experiment.published().exists())
        self.assertTrue((self.folder / "out" / "x-anisotropic" / "results.csv").exists())

    def test_bulk_is_not_published(self):
        self.module.tabulate = lambda _, results: {
            "small": [{"n": n} for n in range(main.PUBLISHED_ROWS)],
            "bulk": [{"n": n} for n in range(main.PUBLISHED_ROWS + 1)]}
        self.run_it()
        experiment, out = Experiment("x", self.module), self.folder / "out" / "x"
        with contextlib.redirect_stdout(io.StringIO()) as said:
            main.publish(experiment, out)
        self.assertIn(f"not copied, more than {main.PUBLISHED_ROWS} rows: {out / 'bulk.csv'}",
                      said.getvalue())
        self.assertTrue((out / "bulk.csv").exists())
        self.assertEqual({path.name for path in experiment.published().iterdir()},
                         {"small.csv", "text.md", "manifest.json"})

    def test_what_is_published_is_small_and_has_no_bulk(self):
        lines = 0
        for path in sorted(PUBLISHED.glob("*/results*/*")):
            with self.subTest(path=path):
                self.assertIn(path.suffix, {".json", ".csv", ".md", ".png", ".jpg"})
                self.assertLess(path.stat().st_size, 500_000)
            if path.suffix in {".json", ".csv", ".md"}:
                lines += path.read_text().count("\n")
        self.assertEqual([main.bulk(folder) for folder in PUBLISHED.glob("*/results*")
                          if main.bulk(folder)], [])
        self.assertLess(lines, 15_000)

    def test_units_that_tables_do_not_tell_apart_are_refused(self):
        self.module.ONE, self.words = ("solver",), ["good", "other"]
        with self.assertRaisesRegex(UsageError, 'one of "solver" at a time, not good, other'):
            self.run_it()
        self.words = []
        with self.assertRaisesRegex(UsageError, "none of the 1 materials"):
            self.run_it()

    def test_a_module_that_python_lacks_is_named(self):
        def lacking(_):
            raise ModuleNotFoundError("No module named 'numpy'", name="numpy")
        with (unittest.mock.patch.object(experiments, "load", lacking),
              contextlib.redirect_stderr(io.StringIO()) as said):
            self.assertEqual(main.main(["x", "--quick"]), 2)
        self.assertRegex(said.getvalue(), "^trilobe-experiments: error: this Python has no numpy; .*check.*\n$")

    def test_the_list_needs_no_packages(self):
        for name in ("numpy", "matplotlib", "PIL", "markdown"):
            (self.folder / f"{name}.py").write_text(f"raise ModuleNotFoundError(name='{name}')")
        program = PUBLISHED / "trilobe-experiments"
        done = subprocess.run([sys.executable, program, "list"], capture_output=True, text=True,
                              check=False, env={**os.environ, "PYTHONPATH": str(self.folder)})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, "(?m)^final_error$")

    def test_all_gives_each_experiment_what_it_takes(self):
        (self.folder / "README.md").write_text("[y](y/README.md) [x](x/README.md)")
        (self.folder / "y").mkdir()
        (self.folder / "y" / "manifest.json").write_text(
            '{"question": "?", "sources": ["synth:felt"], "probe": null, "anisotropic": {"sources": ["synth:linen"]}}')
        for name in ("x", "y"):
            (self.folder / name / "experiment.py").write_text("")
        ran = []

        def run(experiment, options):
            ran.append((experiment.name, options))
            return main.SOME_FAILED if experiment.name == "y" else 0

        with unittest.mock.patch.object(main, "run", run):
            self.assertEqual(main.main(["all", "synth:foam", "--set=probe=p.hdr"]), 3)
            self.assertEqual(main.main(["all", "--set=prob=p.hdr"]), 2)
        self.assertEqual([(name, options.form, options.sources, options.set) for name, options in ran],
                         [("y", "full", [], ["probe=p.hdr"]), ("y", "anisotropic", [], ["probe=p.hdr"]),
                          ("x", "full", ["synth:foam"], [])])

    def test_settings_that_make_no_sense_are_refused(self):
        self.module.units = lambda setting: setting.manifest["flags"]["none"]
        with self.assertRaisesRegex(UsageError, "settings of x are not what it takes .KeyError"):
            self.run_it()


if __name__ == "__main__":
    unittest.main()
