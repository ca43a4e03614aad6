"""The book of records: what lowers a record, and what does not."""
import json

from lab import records, tables
from lab.tests import FolderTest

REPORT = {"source_xxh128": "abc", "valid_samples": 9, "weighting": "appearance", "model": "shared", "lobes": 3,
          "parameters": 822, "prior": None, "relative_objective": 0.1, "solver": "auto"}
SCORER = """#!/bin/sh
# trilobe score MODEL ...: the file beside the model says what E is.
cat "$(dirname "$2")/score.json"
"""


class RecordsTest(FolderTest):
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
        (folder / "score.json").write_text(json.dumps({"objective": objective if scored is None else scored}))

    def update(self):
        return records.update(self.program, self.folder / "units", self.book)

    def rows(self):
        return {row["lobes"]: row for row in tables.read(self.book)}

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
