"""Sources, manifests, tables: what the command line and the files say."""
import json
import types
import unittest

from lab import UsageError, main, manifest, materials, tables
from lab.experiments import Setting
from lab.tests import FolderTest


class SettingsTest(FolderTest):
    def test_sources_of_folders_files_and_names(self):
        for name in ("chrome.binary", "satin_purple_rgb.bsdf", "mine.binary", "readme.txt"):
            (self.folder / name).touch()
        sources = materials.find([str(self.folder), "synth:plastic"])
        self.assertEqual([source.name for source in sources],
                         ["chrome", "mine", "satin_purple", "synth-plastic"])
        self.assertEqual([source.database for source in sources], ["MERL", "own", "RGL", "own"])
        self.assertEqual([source.half for source in sources], ["developing", "", "developing", ""])
        self.assertEqual(materials.Source("aluminium", "").half, "reporting")
        with self.assertRaisesRegex(UsageError, "does not exist"):
            materials.find([str(self.folder / "none.binary")])
        with self.assertRaisesRegex(UsageError, "one material"):
            materials.find([str(self.folder / "mine.binary"), str(self.folder / "../x/mine.binary")
                            .replace("../x", ".")])

    def test_a_subset_does_not_depend_on_the_files_given(self):
        everything = [materials.Source(name, name) for name in materials.MERL + materials.RGL]
        chosen = {source.name for source in materials.every(everything, 4)}
        self.assertEqual(len(chosen), 10 + 6)
        of_one = {source.name for source in materials.every(everything, {"MERL": 4})}
        self.assertEqual(of_one, chosen | set(materials.RGL))
        some = everything[1::2]
        self.assertEqual({source.name for source in materials.every(some, 4)},
                         chosen & {source.name for source in some})

    def test_manifest_forms_and_changes(self):
        path = self.folder / "manifest.json"
        path.write_text(json.dumps({"question": "?", "limits": {"s": 9}, "starts": ["x"],
                                    "runs": [{"every": 4}], "quick": {"limits": {"s": 1}},
                                    "anisotropic": {"limits": {"s": 2}}}))
        self.assertEqual(manifest.load(path, "full")["limits"], {"s": 9})
        self.assertEqual(manifest.load(path, "quick")["limits"], {"s": 1})
        self.assertEqual(manifest.load(path, "anisotropic")["limits"], {"s": 2})
        changed = manifest.load(path, "full", ["limits.s=2.5", 'starts=["y"]', "question=why",
                                              "runs.0.every=1"])
        self.assertEqual(changed, {"question": "why", "limits": {"s": 2.5}, "starts": ["y"],
                                   "runs": [{"every": 1}]})
        for wrong in ("limits.s", "unknown=1", "starts.s=1", "runs.1.every=1", "question.s.t=1"):
            with self.assertRaisesRegex(UsageError, "--set="):
                manifest.load(path, "full", [wrong])

    def test_a_form_that_a_manifest_lacks_is_refused(self):
        path = self.folder / "manifest.json"
        path.write_text(json.dumps({"question": "?", "quick": {}}))
        with self.assertRaisesRegex(UsageError, "no form \"anisotropic\""):
            manifest.load(path, "anisotropic")

    def test_solvers_and_threads_of_the_command_line(self):
        experiment = types.SimpleNamespace(name="x", settings=lambda form, changes: {
            "solvers": {"auto": {}, "awls": {}, "mine": {}}, "sources": ["synth:plastic"],
            "runs": [{"solvers": ["auto", "awls"]}, {"solvers": ["awls"]}]})
        setting = main.setting_of(experiment, main.parse(
            ["x", "--solvers=auto,mine", "--threads=1,2"]))
        self.assertEqual(setting.manifest["runs"],
                         [{"solvers": ["auto", "mine"], "threads": [1, 2]},
                          {"solvers": [], "threads": [1, 2]}])
        experiment.settings = lambda form, changes: {"sources": ["synth:plastic"]}
        with self.assertRaisesRegex(UsageError, "x takes no --solvers"):
            main.setting_of(experiment, main.parse(["x", "--solvers=auto"]))
        with self.assertRaisesRegex(
                UsageError, "no program build/release/experiments/none; ./check builds it .*"
                            "-B build/release -DTRILOBE_BUILD_EXPERIMENTS=ON .* --target none"):
            setting.program("none")

    def test_a_place_may_be_anywhere_but_must_be_there(self):
        (self.folder / "probe.hdr").touch()
        setting = Setting("x", "full", {"probe": f"{self.folder}/../{self.folder.name}/probe.hdr",
                                       "peers": None, "none": "none/of/it"}, [], None, None)
        self.assertEqual(setting.place("probe"), (self.folder / "probe.hdr").resolve())
        self.assertIsNone(setting.place("peers"))
        with self.assertRaisesRegex(UsageError, "none: none/of/it does not exist"):
            setting.place("none")

    def test_shard(self):
        self.assertEqual(main.shard("2/3"), (2, 3))
        for wrong in ("0/3", "4/3", "1", "a/b"):
            with self.assertRaises(UsageError):
                main.shard(wrong)

    def test_tables_read_back(self):
        rows = [{"a": 1, "b": 0.1, "c": "text", "material": "001"},
                {"a": None, "b": float("inf"), "d": 2, "material": "nan"}]
        tables.write(self.folder / "t.csv", rows)
        self.assertEqual(tables.read(self.folder / "t.csv"),
                         [{"a": 1, "b": 0.1, "c": "text", "material": "001", "d": None},
                          {"a": None, "b": float("inf"), "c": None, "material": "nan", "d": 2}])


if __name__ == "__main__":
    unittest.main()
