"""The report is one file that holds what the pages lead to, and says what is missing and of which run it
is."""
import json
import types
import unittest

from lab import report, tables
from lab.tests import FolderTest

PAGE = """# A question?

See [another page](../other/README.md) and [results as such](results/t.md) in a sentence.

![A picture of E\\*](results/p.svg)

[A table](results/t.csv)

[A text](results/t.md)

![Another picture](results/none.svg)
"""


class ReportTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "page.md").write_text(PAGE)
        self.results = self.folder / "results"
        self.results.mkdir()
        (self.results / "p.svg").write_text("<svg/>")
        (self.results / "q.png").write_bytes(b"png")
        tables.write(self.results / "t.csv", [{"solver": "awls", "seconds": 1.25}])
        (self.results / "t.md").write_text("Text with ![a picture](q.png)\n")
        self.experiment = types.SimpleNamespace(name="a", title="A question?",
                                                page=self.folder / "page.md")

    def written(self, results, anisotropic=None, published=True):
        path = self.folder / "report.html"
        of = {"full": report.Results(results, published), "anisotropic": report.Results(anisotropic)}
        report.write(path, [self.experiment], lambda _, form: of[form])
        return path.read_text()

    def test_holds_pictures_tables_and_texts(self):
        page = self.written(self.results)
        self.assertIn('<a href="#a">A question?</a>', page)
        self.assertIn('<h1 id="a">', page)
        self.assertIn('src="data:image/svg+xml;base64,PHN2Zy8+"', page)
        self.assertIn('src="data:image/png;base64,cG5n"', page)
        self.assertIn("A picture of E*", page)
        self.assertIn("<td>1.25</td>", page)
        self.assertIn("Not there yet: Another picture", page)
        self.assertNotIn("README.md", page)  # nothing outside of the file

    def test_holds_the_results_of_both_forms(self):
        self.experiment.page.write_text("# A\n\n[A text](results/t.md)\n\n"
                                        "[Another](results_anisotropic/t.md)\n")
        other = self.folder / "results_anisotropic"
        other.mkdir()
        (other / "t.md").write_text("Of the other form")
        page = self.written(self.results, other)
        self.assertIn("Text with", page)
        self.assertIn("Of the other form", page)
        self.assertEqual(self.written(self.results).count("Not there yet"), 1)

    def test_without_results_everything_is_missing(self):
        self.assertEqual(self.written(None).count("Not there yet"), 4)

    def test_another_run_is_named_and_has_no_text_of_the_published_one(self):
        self.experiment.page.write_text("# A\n\n**E is 17 % lower** on 63 materials.\n\n[A text](results/t.md)\n\n"
                                        "[Another](results_anisotropic/t.md)\n")
        (self.results / "manifest.json").write_text(json.dumps(
            {"form": "quick", "date": "2026-11-26", "sources": ["synth-plastic"], "seconds": 2.0,
             "units": {"made": 3, "all": 3}}))
        self.assertIn("17 % lower", self.written(self.results))
        page = self.written(self.results, self.results, published=False)
        self.assertNotIn("17 % lower", page)
        self.assertIn("of a run of 2026-11-26, quick form, whose figures mean nothing, on 1 material "
                      "(synth-plastic).", page)
        self.assertIn("of the anisotropic form are the published ones", page)
        self.assertIn("Text with", page)
        self.assertLess(page.index("of a run of"), page.index("Text with"))
        (self.results / "manifest.json").unlink()
        self.assertIn("of another run than", self.written(self.results, published=False))

    def test_order_is_that_of_the_index(self):
        index = self.folder / "README.md"
        index.write_text("[x](b/README.md) [y](a/README.md)")
        named = [types.SimpleNamespace(name=name) for name in ("a", "b", "c")]
        self.assertEqual([e.name for e in report.in_order(named, index)], ["b", "a", "c"])


if __name__ == "__main__":
    unittest.main()
