"""Units are made once, whole or not at all, and shards of them merge by themselves."""
import io
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

from lab import campaign
from lab.tests import FolderTest
from lab.units import FOLDER, Product, Store, Unit, UnitFailed

PROGRAM = """#!/bin/sh
# work FOLDER TEXT [FILE]: counts itself, writes TEXT (and FILE's text) into FOLDER/result
echo x >> "{count}"
case $2 in
  fail) echo broken >&2; exit 3 ;;
  idle) exit 0 ;;
  slow) echo half > "$1/result"; sleep 30 ;;
esac
echo "$2" > "$1/result"
if [ -n "$3" ]; then cat "$3" >> "$1/result"; fi
"""


class UnitsTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.count = self.folder / "count"
        self.program = self.folder / "work"
        self.program.write_text(PROGRAM.format(count=self.count))
        self.program.chmod(0o755)
        self.store = Store(self.folder / "units")

    def unit(self, text, *more, **settings):
        return Unit(f"some/{text}", self.program, (FOLDER, text, *more), "result", **settings)

    def times_run(self):
        return len(self.count.read_text()) // 2 if self.count.exists() else 0

    def entries(self):
        return sorted(path.name for path in (self.store.root / "some").iterdir())

    def test_is_made_once(self):
        folder = self.store.make(self.unit("a"))
        self.assertEqual((folder / "result").read_text(), "a\n")
        record = json.loads((folder / "unit.json").read_text())
        self.assertEqual(record["command"], [str(self.program), FOLDER, "a"])
        self.assertGreater(record["machine"]["cores"], 0)
        self.assertGreater(record["processor_seconds"], 0)
        same = self.unit("a", labels={"of": "another experiment"})
        self.assertEqual(self.store.make(same), folder)
        self.assertEqual(self.times_run(), 1)
        self.store.make(same, again=True)
        self.assertEqual(self.times_run(), 2)

    def test_another_command_or_program_is_another_unit(self):
        unit = self.unit("a")
        folder = self.store.make(unit)
        other = Unit(unit.path, self.program, (FOLDER, "b"), "result")
        self.assertNotEqual(self.store.folder(other), folder)
        self.program.write_text(self.program.read_text() + "# rebuilt\n")
        self.program.chmod(0o755)
        self.assertFalse(self.store.is_done(self.unit("a")))

    def test_modules_of_a_program_count_by_what_is_in_them(self):
        module = self.folder / "module.py"
        module.write_text("1")
        folder = self.store.make(self.unit("a", modules=(module,)))
        self.assertNotEqual(self.store.folder(self.unit("a")), folder)
        self.assertTrue(self.store.is_done(self.unit("a", modules=(module,))))
        module.write_text("2")
        self.assertFalse(self.store.is_done(self.unit("a", modules=(module,))))

    def test_files_count_by_what_is_in_them(self):
        data, copy = self.folder / "data", self.folder / "copy"
        for file in (data, copy):
            file.write_text("1\n")
        folder = self.store.make(self.unit("a", str(data)))
        self.assertEqual(self.store.folder(self.unit("a", str(copy))), folder)
        self.assertEqual(self.unit("a", f"x={data}").key, self.unit("a", f"x={copy}").key)
        data.write_text("2\n")
        self.assertFalse(self.store.is_done(self.unit("a", str(data))))

    def test_failure_leaves_a_record_and_no_folder(self):
        for text, says in (("fail", "exit status 3: broken"), ("idle", "did not write result")):
            with self.subTest(text):
                unit = self.unit(text)
                with self.assertRaisesRegex(UnitFailed, says):
                    self.store.make(unit)
                self.assertFalse(self.store.is_done(unit))
                self.assertIn("status", self.store.failure(unit))
        self.assertTrue(all(name.endswith(".failed.json") for name in self.entries()))

    def test_time_limit(self):
        with self.assertRaisesRegex(UnitFailed, "no end after 0.2 s"):
            self.store.make(self.unit("slow", timeout_s=0.2))

    def test_what_a_unit_needs_is_made_first(self):
        first = self.unit("a")
        second = Unit("some/b", self.program, (FOLDER, "b", Product(first, "result")), "result")
        self.assertEqual((self.store.make(second) / "result").read_text(), "b\na\n")
        self.assertTrue(self.store.is_done(first))
        self.assertEqual(second.root, first)

    def test_a_killed_run_leaves_nothing_that_counts(self):
        code = ("import sys; sys.path.insert(0, sys.argv[1])\n"
                "from lab.units import *\n"
                "unit = Unit('some/slow', pathlib.Path(sys.argv[2]), (FOLDER, 'slow'), 'result')\n"
                "Store(sys.argv[3]).make(unit)")
        lab = pathlib.Path(__file__).resolve().parents[2]
        runner = subprocess.Popen([sys.executable, "-c", code, str(lab), str(self.program),
                                   str(self.store.root)])
        deadline = time.monotonic() + 20
        while self.times_run() == 0 and time.monotonic() < deadline:
            time.sleep(0.01)
        os.kill(runner.pid, signal.SIGKILL)
        runner.wait()
        self.assertFalse(self.store.is_done(self.unit("slow")))
        self.assertEqual(len(self.entries()), 1)  # torn
        with self.assertRaises(UnitFailed):
            self.store.make(self.unit("slow", timeout_s=0.1))
        self.assertEqual([name for name in self.entries() if not name.endswith(".failed.json")], [])

    def test_campaign_goes_on_after_failures_and_resumes(self):
        units = [self.unit(text) for text in ("a", "fail", "b", "a")]
        said = io.StringIO()
        failures = campaign.run(self.store, units, out=said)
        self.assertEqual(len(failures), 1)
        self.assertIn("[3/3] some/b", said.getvalue())
        self.assertIn("left", said.getvalue())
        campaign.run(self.store, units, out=said)
        self.assertIn("2 of 3 units are there already", said.getvalue())
        self.assertEqual(self.times_run(), 4)  # only the failure was tried again

    def test_a_failure_that_several_need_is_tried_once(self):
        first = self.unit("fail")
        units = [Unit(f"some/{text}", self.program, (FOLDER, text, Product(first, "result")),
                      "result") for text in "ab"]
        failures = campaign.run(self.store, [first, *units], out=io.StringIO())
        self.assertEqual(len(failures), 3)
        self.assertIn("some/b needs some/fail: exit status 3: broken", failures)
        self.assertEqual(self.times_run(), 1)

    def test_shards_are_disjoint_and_whole(self):
        units = []
        for text in "abcdefg":
            first = self.unit(text)
            units += [first, Unit(f"some/{text}2", self.program,
                                  (FOLDER, "x", Product(first, "result")), "result")]
        parts = [campaign.shard_of(units, i, 3) for i in (1, 2, 3)]
        self.assertEqual(sorted(unit.path for part in parts for unit in part),
                         sorted(unit.path for unit in units))
        for part in parts:  # a unit and the one that it needs stay together
            self.assertEqual({unit.root.path for unit in part},
                             {unit.path for unit in part if not unit.needs})
            campaign.run(self.store, part, out=io.StringIO())
        self.assertEqual(self.times_run(), len(units))
        self.assertTrue(all(self.store.is_done(unit) for unit in units))


if __name__ == "__main__":
    unittest.main()
