"""`trilobe-need`: what is counted is what the picture is made of, and the whole goes from a scene to a page."""

import json
import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import trilobe

mi = pytest.importorskip("mitsuba")
pytest.importorskip("flip_evaluator")
import drjit as dr  # noqa: E402

from trilobe import need  # noqa: E402
from trilobe._need.page import page, totals  # noqa: E402
from trilobe._need.plan import plan_of  # noqa: E402

NO_LLVM = "no LLVM; install libllvm19, set DRJIT_LIBLLVM_PATH"
# Without a path Dr.Jit takes any LLVM, and Debian's 14 to 16 end the process.
if "DRJIT_LIBLLVM_PATH" not in os.environ:
    pytest.skip(NO_LLVM, allow_module_level=True)
try:
    mi.set_variant("llvm_ad_rgb")
    dr.eval(mi.Float([1, 2]) + 1)
except Exception:
    pytest.skip(NO_LLVM, allow_module_level=True)

import trilobe.mitsuba  # noqa: E402, F401
from trilobe._need.count import Counter  # noqa: E402

# A sphere under a lamp far up to the right, and a mirror of it; the camera looks down.
SCENE = """<scene version="3.0.0">
  <default name="lamp" value="0.5"/>
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective"><float name="fov" value="2"/>
    <transform name="to_world"><lookat origin="0, 0, 50" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
      <rfilter type="box"/></film></sensor>
  <emitter type="directional"><vector name="direction" x="-$lamp" y="0" z="-0.866"/>
    <rgb name="irradiance" value="3"/></emitter>
  <bsdf type="twosided" id="plate"><bsdf type="trilobe_measured">
    <string name="filename" value="synth:felt@20x20x40"/></bsdf></bsdf>
  <bsdf type="trilobe" id="unseen"><string name="filename" value="material:paper_white"/></bsdf>
  <shape type="rectangle"><transform name="to_world"><scale value="2"/></transform><ref id="plate"/></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z="90"/><float name="radius" value="0.1"/><ref id="unseen"/>
  </shape>
</scene>
"""


@pytest.fixture(autouse=True)
def variant():
    """Other tests of the same run choose others."""
    mi.set_variant("llvm_ad_rgb")


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.xml"
    path.write_text(SCENE)
    return path


@pytest.mark.parametrize("name", ["room", "backlit", "cloth"])
def test_loads_the_scenes_that_come_along_from_any_folder(name, tmp_path, monkeypatch):
    path = Path(__file__).resolve().parents[2] / "scenes" / f"{name}.xml"
    monkeypatch.chdir(tmp_path)
    file = need.SceneFile(path, {})
    loaded = file.load({material.name: {"type": "trilobe", "filename": material.source} for material in file.materials})
    assert len(file.sides(loaded)) == len(file.materials)


def test_counts_where_the_light_comes_from(scene, tmp_path):
    file = need.SceneFile(scene, {})
    assert [material.name for material in file.materials] == ["plate", "unseen"]
    for material in file.materials:
        material.full = trilobe.load("material:paper_white")
        material.full.save(tmp_path / f"{material.name}.json")
    file.materials[0].measurement = trilobe.read(file.materials[0].source)
    bsdfs = {material.name: need._bsdf(material, "measured", tmp_path / "none") for material in file.materials}
    bsdfs["plate"]["model"] = str(tmp_path / "plate.json")
    bsdfs["unseen"]["filename"] = str(tmp_path / "unseen.json")
    loaded = file.load(bsdfs)
    counter = Counter(loaded, file.sides(loaded), [material.grid for material in file.materials], 3)
    picture = counter.picture(16, seed=1)
    # A picture as Mitsuba's own integrator has it: f cos theta_i E, E 3 across the beam.
    wanted = np.array(mi.render(loaded, spp=16)).mean(axis=(0, 1))
    np.testing.assert_allclose(picture.mean(axis=(0, 1)), wanted, rtol=0.02)
    plate, unseen = counter.count(picture, 16, seed=2)
    assert plate.bins.shape == (20, 20, 40) and unseen.bins.sum() == 0
    assert plate.bins.sum() == pytest.approx(1)
    # Lit at 30 degrees and seen from above, within a degree: half vectors lean by 15, and theta_d is as much.
    theta_h, theta_d = int(np.sqrt(15 / 90) * 20), int(15 / 90 * 20)
    assert plate.bins[theta_h - 1 : theta_h + 2, theta_d - 1 : theta_d + 2].sum() > 0.999
    assert plate.pairs[:2, 29:31].sum() > 0.999


@pytest.mark.skipif("TRILOBE_LONG_TESTS" not in os.environ, reason="takes ten seconds; TRILOBE_LONG_TESTS=1 runs it")
def test_goes_from_a_scene_to_a_page(scene, tmp_path, capsys):
    program = shutil.which("trilobe") or Path(__file__).parents[2] / "build/release/bin/trilobe"
    out = tmp_path / "need"
    status = need.main([
        str(scene), f"--out={out}", "--spp=4", "--count-spp=4", "--delta-e=8", "--moved", "lamp=1.6",
        f"--program={program}", "--max_iterations=2", "--nocache"])
    assert status == 0, capsys.readouterr().err
    report = json.loads((out / "need.json").read_text())
    plate, unseen = report["materials"]
    assert plate["share"] == pytest.approx(1) and unseen["share"] == 0
    assert plate["samples"]["used"] < 0.2 * plate["samples"]["valid"]
    assert plate["parameters"]["pruned"] < 0.5 * plate["parameters"]["full"]
    assert trilobe.load(out / "pruned/plate.json").lobes <= 3
    assert report["totals"]["samples"] == plate["samples"]
    left = plate["parameters"]["pruned"]
    assert f"{left} of {plate['parameters']['full']} parameters are left, {8 * left} bytes" in capsys.readouterr().out
    assert report["differences"]["pruned"]["flip"] < 0.05
    text = (out / "index.html").read_text()
    assert "parameters are left" in text and "Not finished" not in text
    for name in ("measured", "full", "pruned_flip", "moved_pruned"):
        assert f'src="{name}.png"' in text and (out / f"{name}.png").stat().st_size > 100


# Stands for `trilobe fit --scene`: one material is finished after a moment, the other with the plan.
PROGRAM = """
import pathlib, sys, time
out = pathlib.Path(sys.argv[1])
(out / "a.json").write_text("{}")
time.sleep(1.5)
(out / "b.json").write_text("{}")
(out / "plan.json").write_text('{"materials": []}')
"""


def test_tells_what_is_finished_while_the_program_runs(tmp_path):
    (tmp_path / "b.json").write_text("of an earlier run")
    told = []
    command = [sys.executable, "-c", PROGRAM, str(tmp_path)]
    assert plan_of(command, tmp_path, ["a", "b"], told.append) == {"materials": []}
    assert told[0] == "0 of 2 materials; left are a and b"
    assert len(told) == 2 and re.fullmatch(r"1 of 2 materials after \d s, about \d s left for b", told[1])


def test_tells_what_is_left_while_nothing_is_finished(tmp_path):
    told = []
    slow = [sys.executable, "-c", PROGRAM.replace('(out / "a.json").write_text("{}")', "").replace("1.5", "3"),
            str(tmp_path)]
    plan_of(slow, tmp_path, ["a", "b", "c", "d"], told.append, expected=60, every=1)
    assert told[0] == "0 of 4 materials, about 60 s left for a, b and 2 more"
    assert len(told) >= 3
    assert all(re.fullmatch(r"0 of 4 materials after \d s, about 5\d s left for a, b and 2 more", line)
               for line in told[1:])


def test_a_program_that_fails_says_why(tmp_path):
    failing = [sys.executable, "-c", "import sys; sys.exit('trilobe: error: no such scene')"]
    with pytest.raises(trilobe.Error, match="^error: no such scene$"):
        plan_of(failing, tmp_path, [], lambda line: None)


def test_has_a_page_before_all_is_there():
    row = {"name": "wall", "share": 0.0, "measured_bytes": None, "parameters": {"full": 0, "pruned": 0},
           "seconds": {"full": 1.0, "pruned": 0.0}}
    report = {"scene": "room.xml", "doing": "pruning <2 of 3>", "ended": False, "materials": [row], "tries": [],
              "totals": totals([row], {"measured": 2.0}), "pictures": {"measured": {"seconds": 2.0}},
              "differences": {}, "moved": {}}
    text = page(report)
    assert "<p>Not finished yet: pruning &lt;2 of 3&gt;.</p>" in text and 'http-equiv="refresh"' in text
    assert 'src="measured.png"' in text and "full.png" not in text and "never read" not in text
    ended = page({**report, "ended": True})
    assert "<p>Ended early, while pruning" in ended and "refresh" not in ended
    done = page({**report, "doing": ""})
    assert "0 of 0 parameters are left" in done and "never read" in done and "refresh" not in done


def test_writes_a_page_before_it_fits(scene, tmp_path, monkeypatch):
    out = tmp_path / "need"

    def prepare(material, folder):
        text = (out / "index.html").read_text()
        raise trilobe.Error(f"seen {'Not finished yet: fitting plate, 1 of 2.' in text}")

    monkeypatch.setattr(need.Material, "prepare", prepare)
    options = need.Options(1, 1, 1, 0.01, [1], {}, {}, None, [])
    with pytest.raises(trilobe.Error, match="seen True"):
        need.need(scene, out, options)
    assert "Ended early, while fitting plate" in (out / "index.html").read_text()


def test_says_in_a_line_what_is_wrong(scene, tmp_path, capsys):
    def told(*arguments):
        assert need.main([*map(str, arguments)]) == 1
        error = capsys.readouterr().err
        assert error.startswith("trilobe-need: error: ") and error.count("\n") == 1
        return error

    out = f"--out={tmp_path / 'x'}"
    assert "cannot read" in told(tmp_path / "none.xml", out)
    assert "give NAME=VALUE" in told(scene, out, "--moved", "lamp")
    assert "no compiled variant" in told(scene, out, "--variant=scalar_rgb")
    assert "are no numbers" in told(scene, out, "--delta-e=much")
    scene.write_text("<scene version='3.0.0'><emitter type='constant'/></scene>")
    assert "no BSDF of the type trilobe" in told(scene, out)
    scene.write_text(SCENE.replace('type="twosided"', 'type="normalmap"').replace("<bsdf type=\"trilobe_m", """
      <texture name="normalmap" type="checkerboard"/><bsdf type="trilobe_m"""))
    assert "inside a 'normalmap' cannot be counted" in told(scene, out)
