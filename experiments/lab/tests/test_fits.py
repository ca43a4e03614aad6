"""Tests of how fits are planned, and of what is read of them."""
import json
import math
import unittest

from lab import UsageError, fits
from lab.experiments import Setting
from lab.materials import Source
from lab.tests import FolderTest

REPORT = {"objective": 3, "seconds": {"read": 1, "prepare": 2, "init": 0.5},
          "phases": {"tracing": 0.3}}
TRACE = ("iteration,seconds,objective,optimality,processor_seconds\n"
         "0,0.1,9,,1.1\n1,1.1,4,0.5,1.6\n2,2.1,3,0.1,2.1\n")
CONVERGENCE = "iteration,seconds,psnr_db\n0,0.1,20\n2,2.1,inf\n"


class FitsTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "trilobe").touch()

    def setting(self, runs, **more):
        return Setting("x", "full", {"runs": runs, **more}, [Source("a", "a"), Source("b", "b")],
                       self.folder, self.folder / "trilobe")

    def test_plan_is_every_combination_once(self):
        planned = fits.planned(self.setting([
            {"solvers": ["awls", "lm"], "threads": [1, 2]},
            {"solvers": ["awls"], "every": 2},
            {"solvers": ["awls"], "every": 2, "name": "again"}]))
        self.assertEqual(len(planned), 2 * 2 * 2 + 1)
        self.assertEqual(len({unit.key for unit in planned}), 8)  # the last is made already
        self.assertEqual(planned[-1].labels["run"], "again")

    def test_runs_that_are_none_are_refused(self):
        for wrong in ("text", [{"every": 2}], [{"solvers": "awls"}], [{"solvers": [], "every": 0}],
                      [{"solvers": [], "solver": []}], [{"solvers": [], "flags": 1}],
                      [{"solvers": [], "every": {"MERL": 0}}], [{"solvers": [], "every": {"x": 1}}]):
            with self.subTest(wrong), self.assertRaisesRegex(UsageError, "manifest"):
                fits.planned(self.setting(wrong))

    def test_a_solver_may_be_of_another_program(self):
        other = self.folder / "other"
        other.touch()
        unit, = fits.planned(self.setting([{"solvers": ["mine"], "every": 2}],
                                          solvers={"mine": {"program": str(other)}}))
        self.assertEqual(unit.program, other.resolve())
        self.assertFalse(any("program" in word for word in unit.arguments))

    def test_a_report_without_what_is_needed_is_refused(self):
        (self.folder / "report.json").write_text("{}")
        with self.assertRaisesRegex(UsageError, "report.json has no objective"):
            fits.Fit(self.folder)

    def test_a_repeat_is_another_fit(self):
        first, second = fits.planned(self.setting(
            [{"solvers": ["awls"], "every": 2, "repeats": 2}]))
        self.assertEqual(first.arguments, second.arguments)
        self.assertNotEqual(first.key, second.key)
        self.assertEqual(second.labels["repeat"], 2)

    def test_flags_of_a_solver_come_last(self):
        unit, = fits.planned(self.setting(
            [{"solvers": ["mine"], "every": 2, "flags": {"tolerance": 0, "convergence": True}}],
            flags={"tolerance": 1, "max_iterations": 7},
            solvers={"mine": {"solver": "lm", "max_iterations": 9}}))
        for word in ("--solver=lm", "--tolerance=0", "--max_iterations=9", "--convergence"):
            self.assertIn(word, unit.arguments)
        self.assertEqual(unit.labels["solver"], "mine")

    def test_a_weighting_is_a_name_of_the_manifest_or_the_program_or_left_to_it(self):
        units = fits.planned(self.setting(
            [{"solvers": ["awls"], "every": 2, "weightings": ["log", "mine", "power:epsilon=1"]},
             {"solvers": ["awls"], "every": 2}],
            weightings={"mine": {"weighting": "uniform", "robust": 0.1}}))
        words = [[word for word in unit.arguments if word.startswith(("--w", "--ro"))]
                 for unit in units]
        self.assertEqual(words, [["--weighting=log"], ["--robust=0.1", "--weighting=uniform"],
                                 ["--weighting=power:epsilon=1"], []])
        self.assertEqual([unit.labels["weighting"] for unit in units],
                         ["log", "mine", "power:epsilon=1", fits.DEFAULT])
        self.assertEqual(units[2].path, "fit/a/awls-analytic-power-epsilon-1-2t")

    def test_a_database_is_read_with_its_own_flags(self):
        setting = self.setting([{"solvers": ["awls"]}], reading={"RGL": {"max_angle": 75}})
        setting.sources[:] = [Source("chrome", "chrome"), Source("paper_white", "paper_white")]
        read = ["--max_angle=75" in unit.arguments for unit in fits.planned(setting)]
        self.assertEqual(read, [False, True])

    def test_the_clock_starts_with_reading_and_leaves_out_the_trace(self):
        (self.folder / "report.json").write_text(json.dumps(REPORT))
        (self.folder / "trace.csv").write_text(TRACE)
        (self.folder / "convergence.csv").write_text(CONVERGENCE)
        fit = fits.Fit(self.folder)
        for clock, expected in zip((row["clock"] for row in fit.trace), (3.5, 4.4, 5.3)):
            self.assertAlmostEqual(clock, expected)
        self.assertAlmostEqual(fit.convergence[1]["clock"], 5.3)
        self.assertEqual(fit.convergence[1]["psnr_db"], math.inf)
        self.assertTrue(math.isnan(fit.trace[0]["optimality"]))

    def test_processor_seconds_are_those_of_the_process(self):
        (self.folder / "report.json").write_text(json.dumps(REPORT))
        (self.folder / "trace.csv").write_text(TRACE)
        (self.folder / "unit.json").write_text('{"seconds": 8, "processor_seconds": 4}')
        fit = fits.Fit(self.folder, "processor")
        for clock, expected in zip((row["clock"] for row in fit.trace), (1.0, 1.4, 1.8)):
            self.assertAlmostEqual(clock, expected)
        self.assertAlmostEqual(fit.before, 1.0)
        self.assertAlmostEqual(fit.solved, 1.8)
        self.assertEqual(fit.all, 4)
        self.assertEqual(fits.Fit(self.folder).all, 3.5)

    def test_a_clock_that_is_none_is_refused(self):
        self.assertEqual(fits.clock(self.setting([])), "wall")
        self.assertEqual(fits.clock(self.setting([], clock="processor")), "processor")
        with self.assertRaisesRegex(UsageError, "\"clock\" is 'sun'"):
            fits.clock(self.setting([], clock="sun"))


if __name__ == "__main__":
    unittest.main()
