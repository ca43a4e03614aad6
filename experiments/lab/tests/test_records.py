"""The book of records: what lowers a record, and what does not."""
import io
import json
from contextlib import redirect_stderr, redirect_stdout

from lab import records, tables
from lab.materials import Source
from lab.tests import FolderTest
from lab.units import Store

REPORT = {"source_xxh128": "abc", "valid_samples": 9, "weighting": "appearance", "model": "shared", "lobes": 3,
          "parameters": 822, "prior": None, "relative_objective": 0.1, "solver": "auto",
          "light": {"lobes": [{"share": 0.5}, {"share": 0.25}]}}
MODEL = {"G": [[1.0, 2.0], [3.0, 0.5]]}
SCORER = """#!/bin/sh
# trilobe score MODEL ...: the file beside the model says what E is.
cat "$(dirname "$2")/score.json"
"""
# trilobe fit nylon.binary ... --out=DIR ...: copies what it is to find; trilobe score as above.
SEARCHER = """#!/bin/sh
[ "$1" = score ] && { cat "$(dirname "$2")/score.json"; exit; }
echo "$@" >> {folder}/searched
for word in "$@"; do case $word in --out=*) cp {folder}/found/* "${word#--out=}";; esac; done
"""


class BookTest(FolderTest):
    """A book of its own, and fits in a folder of units."""

    def setUp(self):
        super().setUp()
        self.program = self.folder / "trilobe"
        self.program.write_text(SCORER)
        self.program.chmod(0o755)
        self.book = self.folder / "records" / "records.csv"

    def fit(self, name, objective, *flags, scored=None, **report):
        folder = self.folder / "units" / "fit" / "nylon" / name
        folder.mkdir(parents=True)
        command = ["/x/trilobe", "fit", "/y/nylon.binary", "--out={folder}", "--noise=0", *flags]
        (folder / "unit.json").write_text(json.dumps({"command": command, "revision": "1a2b"}))
        (folder / "report.json").write_text(json.dumps({**REPORT, "objective": objective, **report}))
        (folder / "model.json").write_text(json.dumps(MODEL))
        (folder / "score.json").write_text(json.dumps({"objective": objective if scored is None else scored}))

    def update(self):
        return records.update(self.program, self.folder / "units", self.book)

    def rows(self):
        return {row["lobes"]: row for row in tables.read(self.book)}


class RecordsTest(BookTest):
    def test_the_lowest_of_each_form_is_kept_with_its_command(self):
        self.fit("a", 4.0, "--solver=awls")
        self.fit("b", 3.0, "--solver=auto", "--max_angle=75", "--threads=1")
        self.fit("one", 8.0, lobes=1)
        self.update()
        self.assertEqual([row["objective"] for row in self.rows().values()], [8, 3])
        self.assertEqual(self.rows()[3]["command"], "trilobe fit nylon.binary --solver=auto --max_angle=75")
        self.assertEqual(self.rows()[3]["revision"], "1a2b")

    def test_a_record_is_lowered_and_never_raised(self):
        self.fit("a", 4.0)
        self.update()
        self.fit("b", 5.0)
        self.assertEqual(len(self.update()), 1)
        self.assertEqual(self.rows()[3]["objective"], 4)
        self.fit("c", 3.5)
        self.assertRegex(self.update()[1], "nylon, appearance, shared: 4 is now 3.5 by auto")
        self.assertEqual(self.rows()[3]["objective"], 3.5)

    def test_a_model_that_the_scorer_does_not_confirm_sets_no_record(self):
        self.fit("a", 4.0)
        self.fit("b", 3.0, scored=4.5)
        self.assertIn("is not what its report says", " ".join(self.update()))
        self.assertEqual(self.rows(), {})

    def test_other_data_and_other_objectives_are_left_out(self):
        self.fit("a", 4.0)
        self.fit("b", 1.0, "--corrupt=noise:0.2")
        self.fit("c", 1.0, "--robust=0.1")
        self.fit("d", 1.0, prior={"strength": 1})
        self.update()
        self.assertEqual(self.rows()[3]["objective"], 4)

    def test_the_key_tells_data_and_weighting_apart(self):
        keys = {records.key_of({**REPORT, **other}, "nylon")
                for other in ({}, {"valid_samples": 8}, {"weighting": "uniform"}, {"lobes": 2})}
        self.assertEqual(len(keys), 4)

    def test_a_model_that_none_would_call_one_is_told(self):
        self.fit("a", 4.0)
        self.update()
        self.assertEqual((self.rows()[3]["degenerate"], self.rows()[3]["largest_G"]), (0, 3))
        for name, objective, model, light in (("b", 3.0, {"G": [[[30000.0]]]}, REPORT["light"]),
                                              ("c", 2.0, MODEL, {"lobes": [{"share": 0.9}, {"share": 1e-5}]})):
            self.fit(name, objective, light=light)
            (self.folder / "units" / "fit" / "nylon" / name / "model.json").write_text(json.dumps(model))
            self.update()
            self.assertEqual(self.rows()[3]["degenerate"], 1)

    def test_new_records_are_left_out_where_an_experiment_only_lowers_old_ones(self):
        self.fit("a", 4.0)
        records.update(self.program, self.folder / "units", self.book, new=False)
        self.assertFalse(self.book.exists())
        self.update()
        self.fit("b", 3.0)
        records.update(self.program, self.folder / "units", self.book, new=False)
        self.assertEqual(self.rows()[3]["objective"], 3)

    def test_tables_follow_the_book(self):
        self.fit("a", 4.0)
        self.update()
        rows = [{"material": "nylon", "objective": 6.0, **records.columns(REPORT, "nylon"), "record": None},
                {"material": "brass", "objective": 7.0, **records.columns(REPORT, "brass"), "record": 7.0},
                {"material": "nylon"}]
        self.assertTrue(records.refresh(rows, self.book))
        self.assertEqual([row.get("record") for row in rows], [4, 7, None])
        self.assertEqual([row.get("over_record") for row in rows], [0.5, 0, None])
        self.assertFalse(records.refresh(rows, self.book))

    def test_runs_of_a_study_set_records_with_the_command_that_makes_them(self):
        folder = self.folder / "study" / "nylon" / "awls-1"
        folder.mkdir(parents=True)
        options = {"max_iterations": 7, "max_seconds": None, "relative_decrease_tolerance": 0.001}
        report = {**REPORT, "objective": 2.0, "source": "/y/nylon.binary", "program": "trilobe 0.2.0", "init": "random",
                  "seed": 5, "raw": True, "max_angle": 75.0, "noise": 0.0, "options": {"given": options}}
        (folder / "report.json").write_text(json.dumps(report))
        (folder / "model.json").write_text(json.dumps(MODEL))
        (folder / "score.json").write_text(json.dumps({"objective": 2.0}))
        noisy = folder.with_name("awls-2")
        noisy.mkdir()
        (noisy / "report.json").write_text(json.dumps({**report, "objective": 1.0, "noise": 0.1}))
        (noisy / "model.json").write_text(json.dumps(MODEL))
        records.update(self.program, self.folder / "study", self.book)
        self.assertEqual(self.rows()[3]["objective"], 2)
        self.assertEqual(self.rows()[3]["command"], "trilobe fit nylon.binary --init=random --lobes=3 --max_angle=75 "
                         "--max_iterations=7 --raw --seed=5 --solver=auto --tolerance=0.001 --weighting=appearance")


class SearchTest(BookTest):
    """A search of the one record in the book, E = 4, by a program that finds what is in `found`."""

    def setUp(self):
        super().setUp()
        self.fit("a", 4.0, "--solver=auto", "--max_angle=75")
        self.update()
        self.program.write_text(SEARCHER.replace("{folder}", str(self.folder)))
        (self.folder / "found").mkdir()
        self.searched = self.folder / "searched"

    def search(self, objective, minima=(1, 1, 2), checksum="abc", **options):
        starts = [{"name": f"roughness/{k}", "objective": 1.0 * of, "minimum": of} for k, of in enumerate(minima)]
        starts.append({"name": "wide", "objective": 1.005, "minimum": 3})
        report = {**REPORT, "objective": objective, "starts": starts, "solver": "multistart", "source": "nylon.binary",
                  "source_xxh128": checksum}
        for name, content in (("report", report), ("model", MODEL), ("score", {"objective": objective})):
            (self.folder / "found" / f"{name}.json").write_text(json.dumps(content))
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            return records.search(self.program, Store(self.folder / "search"), [Source("nylon", "./nylon.binary")],
                                  self.book, **options)

    def test_a_lower_one_becomes_the_record_and_says_how_many_starts_came_there(self):
        self.assertEqual(self.search(3.0), [])
        row = self.rows()[3]
        self.assertEqual((row["objective"], row["solver"], row["starts"], row["came_there"], row["minima"]),
                         (3, "multistart", 4, 2, 3))
        self.assertEqual((row["random"], row["random_lower"]), (3, 0))
        self.assertEqual(row["new_minimum"], 1)  # 2 * 3 / (3 * 2)
        self.assertIn("--max_angle=75", row["command"])
        self.assertIn("--starts=40", self.searched.read_text())

    def test_random_starts_that_end_below_all_others_are_counted(self):
        self.search(3.0, minima=(1, 2, 2))
        self.assertEqual(self.rows()[3]["random_lower"], 0)  # by half a percent
        self.search(2.0, minima=(0, 0, 1), again=True)
        self.assertEqual(self.rows()[3]["random_lower"], 2)

    def test_a_higher_one_leaves_the_record_to_which_none_came(self):
        self.search(4.1)
        self.assertEqual((self.rows()[3]["objective"], self.rows()[3]["came_there"]), (4, 0))

    def test_one_that_is_as_low_tells_how_many_came_to_the_record(self):
        self.search(4.001)
        self.assertEqual((self.rows()[3]["objective"], self.rows()[3]["came_there"]), (4, 2))

    def test_what_has_been_searched_is_not_searched_again(self):
        self.search(3.0)
        self.search(2.0)
        self.assertEqual(self.rows()[3]["objective"], 3)
        self.search(2.0, again=True)
        self.assertEqual(self.rows()[3]["objective"], 2)
        self.assertEqual(len(self.searched.read_text().splitlines()), 2)

    def test_a_fit_that_falls_far_below_a_search_says_that_no_start_came_there(self):
        self.search(3.0)
        self.fit("b", 2.0, scored=2.0)
        self.update()
        self.assertEqual((self.rows()[3]["objective"], self.rows()[3]["starts"], self.rows()[3]["came_there"]),
                         (2, 4, 0))

    def test_another_file_of_the_name_is_told_and_leaves_the_book_alone(self):
        before = self.book.read_text()
        self.assertRegex(self.search(3.0, checksum="def")[0], "nylon: this file has the checksum def, that in .* abc")
        self.assertEqual(self.book.read_text(), before)
