"""The gallery runs."""

import os
import pathlib
import shutil
import subprocess
import sys

import pytest

pytest.importorskip("trilobe._fit")
pytest.importorskip("matplotlib")

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "python" / "examples"
FILES = {
    "fit_arrays": ["model.json", "slices.png"],
    "compare_solvers": ["trace.png"],
    "other_optimisers": ["optimisers.csv", "synth_copper@12x12x24.png"],
    "stability": ["starts.png"],
    "texels": ["texels.png"],
    "batch_table": ["table.csv"],
    "which_directions": ["directions.png"],
    "edit_material": ["edited.png", "edited.json"],
    "mitsuba_scene": ["mitsuba_scene.png"],
    "mitsuba_recover": ["before.png", "after.png", "recovered.json"],
}


def test_all_are_here():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(FILES)


@pytest.mark.parametrize("name", FILES)
def test_runs(name, tmp_path):
    more = []
    if name.startswith("mitsuba"):
        mi = pytest.importorskip("mitsuba")
        import drjit as dr
        try:
            mi.set_variant("llvm_ad_rgb")
            dr.eval(mi.Float([1, 2]) + 1)
        except Exception:
            if name == "mitsuba_recover":
                pytest.skip("no LLVM")
            more = ["--variant=scalar_rgb"]
    if name == "other_optimisers":
        pytest.importorskip("scipy")
    if name == "batch_table":
        pytest.importorskip("pandas")
        beside = shutil.which("trilobe", path=pathlib.Path(sys.executable).parent)
        more = [f"--program={beside or EXAMPLES.parents[1] / 'build/release/bin/trilobe'}"]
    environment = {**os.environ, "TQDM_DISABLE": "1"}
    run = subprocess.run([sys.executable, EXAMPLES / f"{name}.py", "--quick", f"--out={tmp_path}", *more],
                         capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stderr
    assert run.stdout
    for file in FILES[name]:
        assert (tmp_path / file).stat().st_size > (50 if file.endswith(".csv") else 1000)
