"""Measurements and fits: the program's, to the bit."""

import inspect
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time
import typing

import numpy as np
import pytest

import trilobe

from models import SMALL, anisotropic, directions, isotropic

pytest.importorskip("trilobe._fit")

PROGRAM = pathlib.Path(os.environ.get("TRILOBE_PROGRAM", "build/release/bin/trilobe")).resolve()
needs_program = pytest.mark.skipif(not PROGRAM.exists(), reason=f"{PROGRAM} is not built")


@pytest.fixture(scope="module")
def fitted(plastic):
    return trilobe.fit(plastic, solver="awls", max_iterations=4, progress=False)


def without_times(text):
    return [line for line in text.splitlines()
            if not any(f'"{key}"' in line for key in ("seconds", "date", "run", "key"))]


def without_seconds(value):
    """A list of steps with `seconds` set to None; anything else as it is."""
    if not isinstance(value, list):
        return value
    return [{**step, "seconds": None} if isinstance(step, dict) else step for step in value]


@needs_program
@pytest.mark.parametrize(("source", "flags"), [
    (SMALL, {}),
    (SMALL, {"solver": "awls", "max_iterations": 3, "g_filter": 0.5, "model": "independent"}),
    (SMALL, {"solver": "varpro", "max_iterations": 3, "stretch": (-0.2, 0.3), "lobes": 2}),
    ("synth:shot_silk@4x8", {"solver": "lm", "max_iterations": 1, "f_bins": 5, "prior": 0.5}),
    ("synth:linen@4x12", {"model": "auto", "solver": "awls", "max_iterations": 2, "lobes": 1, "max_parameters": 300}),
])
def test_is_the_programs_to_the_bit(source, flags, tmp_path):
    result = trilobe.fit(trilobe.read(source, noise=0.02), **flags, progress=False)
    result.save(tmp_path / "python")
    told = [f"--{key}={','.join(map(str, value)) if isinstance(value, tuple) else value}"
            for key, value in flags.items()]
    subprocess.run([PROGRAM, "fit", source, "--noise=0.02", f"--out={tmp_path}/program", "--noplots", *told],
                   check=True, stdout=subprocess.DEVNULL)
    ours, theirs = (without_times((tmp_path / name / "model.json").read_text()) for name in ("python", "program"))
    assert ours == theirs
    report = json.loads((tmp_path / "program" / "report.json").read_text())
    for key, value in report.items():
        if key not in ("seconds", "phases", "peak_memory_bytes", "key", "run", "files", "date", "candidates",
                       "nodes"):
            assert without_seconds(result.report[key]) == without_seconds(value), key
    rows = np.genfromtxt(tmp_path / "program" / "trace.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(result.trace["objective"], rows["objective"])
    np.testing.assert_array_equal(result.trace["step"], rows["step"])


def test_says_how_it_went(plastic, fitted):
    assert fitted.trace["iteration"].tolist() == [0, 1, 2, 3, 4]
    assert (np.diff(fitted.trace["objective"]) < 0).all()
    assert 0 < fitted.report["objective"] <= fitted.trace["objective"][-1]
    assert fitted.report["solver"] == "awls"
    assert fitted.model.fit["source"] == SMALL
    assert fitted.verdict
    assert not fitted.interrupted
    scored = trilobe.score(fitted.model, plastic)
    assert scored["objective"] == pytest.approx(fitted.report["objective"])
    assert scored["verdict"]["words"] == fitted.verdict


def test_goes_on_from_a_model(plastic, fitted):
    more = trilobe.fit(plastic, solver="varpro", start=fitted.model, max_iterations=2, progress=False)
    assert more.report["objective"] < fitted.report["objective"]


def test_fits_arrays():
    """A model's own values, at random directions, come back."""
    brdf = isotropic()
    wi, wo = directions(6000, 1), directions(6000, 2)
    measurement = trilobe.Measurement(wi, wo, brdf.eval(wi, wo), anisotropic=False, min_theta_d=0)
    assert measurement.counts["valid"] == 6000 and not measurement.anisotropic
    result = trilobe.fit(measurement, progress=False)
    wi, wo = directions(2000, 3), directions(2000, 4)
    error = np.abs(np.log((1 + result.model.eval_cos(wi, wo)) / (1 + brdf.eval_cos(wi, wo))))
    assert np.median(error) < 0.005


def test_arrays_are_counted_like_a_file():
    wi, wo = directions(100, 5), directions(100, 6)
    rho = np.full((100, 3), 0.2)
    rho[0] = -1
    rho[1] = np.nan
    wi[2] = [0, 0, -1]
    wi[3] = np.nan
    measurement = trilobe.Measurement(wi, wo, rho)
    counts = measurement.counts
    assert (counts["valid"], counts["negative"], counts["non_finite"], counts["below_surface"]) == (96, 1, 1, 2)
    assert measurement.anisotropic
    np.testing.assert_allclose(measurement.wi, wi[4:], atol=1e-12)
    one_channel = trilobe.Measurement(wi, wo, rho[:, 0])
    assert one_channel.rho.shape == (96, 3)


def test_read_has_the_options_of_the_program():
    flags = trilobe._fitting.extension.fits().source_options()
    keywords = {"data_seed" if name == "seed" else name: parameter.default
                for name, parameter in inspect.signature(trilobe.read).parameters.items()
                if name not in ("source", "threads")}
    assert set(keywords) == set(flags)
    for name, default in keywords.items():
        assert name == "data_seed" or str(default) == str(flags[name]) or float(default) == flags[name]
        assert f"{'seed' if name == 'data_seed' else name}: " in trilobe.read.__doc__
        if default is not False:
            with pytest.raises(trilobe.Error, match=name.replace("data_", "")):
                trilobe.read(SMALL, **{"seed" if name == "data_seed" else name: object()})


def test_fit_has_the_options_of_the_program():
    flags = trilobe._fitting.extension.fits().fit_options()
    of_python = {"measurement", "start", "weights", "seed", "threads", "progress", "callback", "stop", "solver_options"}
    keywords = inspect.signature(trilobe.fit).parameters
    # Spectra and blocks that are held out are the program's alone.
    assert set(keywords) - of_python == set(flags) - {"spectral", "held_out"}
    for name in set(keywords) - of_python:
        default = keywords[name].default
        assert default is None or str(default) == str(flags[name]) or float(default) == flags[name]
        assert f"{name}: " in trilobe.fit.__doc__
        with pytest.raises(trilobe.Error, match=name):
            trilobe.fit(SMALL, **{name: object()})


def test_models_have_the_names_of_the_program():
    assert list(typing.get_args(trilobe._fitting.options.Form)) == trilobe._fitting.extension.fits().form_names()


def test_takes_out_the_tilt_that_the_highlight_shows():
    tilted = trilobe.read("synth:plastic", corrupt="tilt:2", tilt="auto")
    assert [note for note in tilted.notes if 'tilt="auto" takes out' in note and "2 deg" in note]
    with pytest.raises(trilobe.Error, match="tilt=\"auto\" goes by the highlight"):
        trilobe.read("synth:felt", tilt="auto")
    with pytest.raises(trilobe.Error, match="tilt=\"a lot\": give a number of degrees"):
        trilobe.read(SMALL, tilt="a lot")


def test_reads_a_table(plastic, tmp_path):
    assert plastic.grid == (24, 24, 48)
    assert plastic.wi.shape == plastic.wo.shape == plastic.rho.shape == (27648, 3)
    counts = plastic.counts
    assert plastic.valid.sum() == counts["valid"]
    for k, name in enumerate(plastic.reasons):
        if k > 0:
            assert (plastic.reason == k).sum() == counts[name]
    assert (plastic.rho[plastic.valid] >= 0).all()
    np.testing.assert_allclose(np.linalg.norm(plastic.wi, axis=1), 1)
    assert (np.minimum(plastic.wi, plastic.wo)[plastic.valid, 2] > 0).all()
    nearer = trilobe.read(SMALL, max_angle=60)
    assert nearer.counts["beyond_max_angle"] > 0 and nearer.max_angle == 60
    with pytest.raises(ValueError, match="read-only"):
        plastic.rho[0] = 1


def test_reads_the_wavelengths_that_are_asked_for(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("theta_i,theta_o,phi_o,450,550,650,940\n10,20,180,.125,.25,.5,1\n")
    for bands in ("450,550,940", [940, 550, 450], np.array([450, 550, 940])):
        measurement = trilobe.read(path, bands=bands)
        np.testing.assert_array_equal(measurement.rho, [[1, 0.25, 0.125]])
        assert "940, 550, 450 nm of 4 wavelengths as r, g, b" in measurement.notes[0]
    np.testing.assert_array_equal(trilobe.read(path, bands=550).rho, [[0.25, 0.25, 0.25]])
    with pytest.raises(trilobe.Error, match="no wavelength of 532 nm for bands="):
        trilobe.read(path, bands=532)
    for bands in (None, [[550], [1, 2]], "green", [450, 550]):
        with pytest.raises(trilobe.Error, match="bands"):
            trilobe.read(path, bands=bands)


def test_converts(fitted, plastic, tmp_path):
    for name in ("a.binary", "a.bsdf", "a.glsl"):
        trilobe.convert(fitted.model, tmp_path / name, error=0.2)
        assert (tmp_path / name).stat().st_size > 1000
    again = trilobe.read(tmp_path / "a.binary")
    wi, wo = again.wi[again.valid][::999], again.wo[again.valid][::999]
    np.testing.assert_allclose(again.rho[again.valid][::999], fitted.model.eval(wi, wo), rtol=0.2, atol=1e-3)
    trilobe.convert(plastic, tmp_path / "b.csv")
    assert trilobe.read(tmp_path / "b.csv").counts["valid"] == plastic.counts["valid"]
    told = trilobe.convert(plastic, tmp_path / "d.bsdf", error=0.2)
    assert told[0].startswith("fitted ") and told[1].endswith("for one of a hundred directions")
    assert trilobe.read(tmp_path / "d.bsdf").kind.startswith("RGL")
    for name, kind in (("e.zemax.bsdf", "Zemax"), ("e.xml", "Radiance")):
        trilobe.convert(fitted.model, tmp_path / name)
        assert trilobe.read(tmp_path / name).kind.startswith(kind)
    trilobe.convert("material:linen", tmp_path / "c.bin")
    assert trilobe.read(tmp_path / "c.bin").anisotropic


def test_takes_the_materials_that_come_along(plastic):
    assert len(trilobe.materials()) > 20
    brdf = trilobe.load("material:paper_white")
    assert brdf == trilobe.load(pathlib.Path(__file__).parents[2] / "materials/paper_white.json")
    assert trilobe.score("material:paper_white", plastic)["verdict"]
    with pytest.raises(trilobe.Error, match="did you mean 'material:linen'"):
        trilobe.load("material:linnen")


def test_matches_lobes(fitted, tmp_path):
    brdf = fitted.model
    turned = brdf.replace(s=brdf.s[::-1] * 4, D=brdf.D[::-1] / 4, G=brdf.G[::-1])
    same = trilobe.match_lobes(brdf, turned)
    assert same.lobe == list(range(brdf.lobes))[::-1]
    assert same.agreement == pytest.approx(1) and same.match == pytest.approx([1] * brdf.lobes)
    stronger = brdf.replace(s=brdf.s * 5)
    stronger.save(tmp_path / "stronger.json")
    assert trilobe.match_lobes(brdf, tmp_path / "stronger.json").agreement == pytest.approx(0.2)
    fewer = trilobe.Brdf(brdf.d, brdf.s[:1], brdf.D[:1], brdf.F, brdf.G[:1])
    assert trilobe.match_lobes(brdf, fewer).lobe == [0] + [-1] * (brdf.lobes - 1)
    with pytest.raises(trilobe.Error, match="same sharing and axes"):
        trilobe.match_lobes(isotropic(), isotropic(60))


def test_lists():
    solvers = trilobe.solvers()
    assert solvers[0].name == "auto"
    assert solvers[0].options["max_iterations"][0] == 100
    assert next(iter(trilobe.weightings())) == "appearance"
    assert next(iter(trilobe.initial_models())) == "analytic"
    assert "plastic" in trilobe.synthetic_materials()


BAD = [
    (lambda: trilobe.read("synth:nothing"), "nothing"),
    (lambda: trilobe.read("/no/such.binary"), "/no/such.binary"),
    (lambda: trilobe.read(3), "a path must be a str"),
    (lambda: trilobe.read(SMALL, noise=-1), "noise"),
    (lambda: trilobe.read(SMALL, noise="much"), "noise must be a number"),
    (lambda: trilobe.read(SMALL, seed=-1), "seed=-1: give an integer from 0"),
    (lambda: trilobe.read(SMALL, threads=-1), "threads is negative"),
    (lambda: trilobe.fit(SMALL, model="round"), "unknown model 'round'"),
    (lambda: trilobe.fit(SMALL, model=None), "model must be a text"),
    (lambda: trilobe.fit(SMALL, solver="best"), "best"),
    (lambda: trilobe.fit(SMALL, max_parameters=500), 'max_parameters= goes with model="auto"'),
    (lambda: trilobe.fit(SMALL, raw=True, robust=0.1), "leave out robust="),
    (lambda: trilobe.fit(SMALL, model="auto", smoothness=0.1), "for a form that is given"),
    (lambda: trilobe.fit(SMALL, solver="awls", memory=3), "solver awls does not take memory; it takes"),
    (lambda: trilobe.fit(SMALL, max_iterations="9"), "max_iterations must be an integer"),
    (lambda: trilobe.fit(SMALL, max_iterations=-9), "max_iterations"),
    (lambda: trilobe.fit(SMALL, lobes=99), "lobes"),
    (lambda: trilobe.fit(SMALL, stretch=(1, 2, 3)), "stretch must be"),
    (lambda: trilobe.fit(SMALL, stretch=[(0, 1), (1, 0)]), "has 2 pairs for 3 lobes"),
    (lambda: trilobe.fit(SMALL, d_nodes="many"), 'd_nodes="many": give nodes'),
    (lambda: trilobe.fit(SMALL, d_nodes=np.zeros((3, 3))), "d_nodes must be a text"),
    (lambda: trilobe.fit(SMALL, nodes=np.zeros((3, 3))), "nodes must be a text"),
    (lambda: trilobe.Measurement([[0, 0, 1]], [[0, 0, 1]], [1.0], anisotropic=np.ones(2)), "must be True, False"),
    (lambda: isotropic().unobserved(np.ones((2, 2))), "there is no factor array"),
    (lambda: trilobe.fit(SMALL, weighting="light"), "light"),
    (lambda: trilobe.fit(SMALL, init="there"), "there"),
    (lambda: trilobe.fit(SMALL, start=3), "must be a trilobe.Brdf"),
    (lambda: trilobe.fit(SMALL, prior=1), "prior"),
    (lambda: trilobe.fit(SMALL, progress=np.ones(2)), "progress must be True or False"),
    (lambda: trilobe.fit(None), "a path must be"),
    (lambda: trilobe.Measurement([[0, 0, 1]], [[0, 0, 1]], [[1, 1]]), r"rho has the shape \(1, 2\)"),
    (lambda: trilobe.Measurement([[0, 0, 1]], [[0, 0, 1]] * 2, [1.0]), "rows"),
    (lambda: trilobe.fit(trilobe.Measurement(np.empty((0, 3)), np.empty((0, 3)), [])), "valid"),
    (lambda: trilobe.Measurement("x", [[0, 0, 1]], [1.0]), "wi has the dtype"),
    (lambda: trilobe.score(None, SMALL), "must be a trilobe.Brdf"),
    (lambda: trilobe.convert(isotropic(), "x.png"), "writes no '.png'.*[.]bsdf.*[.]mtlx.*[.]glsl or [.]hlsl$"),
    (lambda: trilobe.convert(SMALL, "x.zip"), "writes no '.zip'.*[.]binary.*[.]xompt.* or [.]usda$"),
    (lambda: trilobe.convert(isotropic(), "x.JSON"), r"model\.save\(path\) writes a model file"),
    (lambda: trilobe.convert(SMALL, "x.glsl"), "fit it first"),
    (lambda: trilobe.convert(SMALL, "x.bsdf", error=2), "error must be from 0 to 1"),
    (lambda: trilobe.convert(anisotropic(), "x.binary"), "anisotropic"),
    (lambda: trilobe.fit_many([], "out"), "there is no source"),
    (lambda: trilobe.fit_many(3, "out"), "a list of paths"),
    (lambda: trilobe.fit_many([SMALL], "out", program="no/where"), "cannot run 'no/where': No such file"),
]


@pytest.mark.parametrize(("ask", "told"), BAD)
def test_says_in_a_line_what_is_wrong(ask, told):
    with pytest.raises(trilobe.Error, match=told) as caught:
        ask()
    assert "\n" not in str(caught.value)


def test_errors_have_a_kind_and_facts(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("theta_i,phi_i,theta_o,phi_o,r,g,b\n1,2,3,4,5,6,7\n1,2,3,abc,5,6,7\n")
    with pytest.raises(trilobe.Error) as caught:
        trilobe.read(path)
    error = caught.value
    assert (error.kind, error.file, error.line) == ("format", str(path), 3)
    assert (error.key, error.value) == ("phi_o", "abc")
    with pytest.raises(trilobe.Error) as caught:
        trilobe.fit(SMALL, weighting="light")
    error = caught.value
    assert (error.kind, error.key, error.value) == ("unknown", "weighting", "light")
    assert (error.file, error.line) == (None, None)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert (again.kind, again.key, again.value) == ("unknown", "weighting", "light")


LONG = """
import signal
import trilobe
signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever a script in the background passes on
result = trilobe.fit("synth:plastic", solver="awls", max_iterations=1000, tolerance=0, progress=True)
assert result.interrupted and result.report["interrupted"], result.report["stop_reason"]
assert result.model.lobes == 3
print("kept", flush=True)
"""


def test_ctrl_c_keeps_the_best_so_far():
    pytest.importorskip("tqdm")
    environment = {key: value for key, value in os.environ.items() if key != "TQDM_DISABLE"}
    process = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True,
                               stderr=subprocess.PIPE, env=environment)
    told = ""
    while "3it" not in told:  # there is a model
        more = process.stderr.read(1)
        assert more, told
        told += more
    process.send_signal(signal.SIGINT)
    out, more = process.communicate(timeout=60)
    assert process.returncode == 0, told + more
    assert "kept" in out


def test_other_threads_run_meanwhile(plastic):
    steps = []
    done = threading.Event()

    def count():
        while not done.is_set():
            steps.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    trilobe.fit(plastic, solver="awls", max_iterations=5, progress=False)
    done.set()
    thread.join()
    assert len(steps) > 20


@needs_program
def test_fits_many(tmp_path, monkeypatch):
    monkeypatch.setenv("TRILOBE_TEST_LIGHTS", "6")
    rows = trilobe.fit_many(["synth:felt@20x20x40", SMALL], tmp_path, program=PROGRAM, workers=2, solver="awls",
                            max_iterations=1, noise=0.01)
    assert [row["state"] for row in rows] == ["fitted", "fitted"]
    assert all(row["psnr_db"] > 10 for row in rows)
    assert trilobe.load(tmp_path / rows[0]["name"]).lobes == 3
    fitted_at = (tmp_path / rows[0]["name"] / "model.json").stat().st_mtime_ns
    again = trilobe.fit_many("synth:felt@20x20x40", tmp_path, program=PROGRAM, solver="awls", max_iterations=1,
                             noise=0.01)
    assert [row["name"] for row in again] == [row["name"] for row in rows]
    assert (tmp_path / rows[0]["name"] / "model.json").stat().st_mtime_ns == fitted_at
    with pytest.raises(trilobe.Error, match="noise"):
        trilobe.fit_many([SMALL], tmp_path, program=PROGRAM, noise=-1)


def test_names_of_a_batch_are_no_formulas():
    from trilobe._fitting.batch import _cell

    for text, value in {"'=1+1": "=1+1", "''=": "'=", "'-3": "-3", "-3": -3.0, "it's": "it's", "'a": "'a"}.items():
        assert _cell(text) == value


def test_draws(fitted, plastic, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    from trilobe import plot
    for name, figure in {
        "factors": plot.factors(fitted.model), "polar": plot.factors(anisotropic()),
        "slices": plot.slices(fitted.model, plastic), "spheres": plot.spheres(fitted.model, plastic, size=48),
        "sphere": plot.spheres(anisotropic(), size=48), "trace": plot.trace({"awls": fitted}),
    }.items():
        figure.savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000
        matplotlib.pyplot.close(figure)
    with pytest.raises(trilobe.Error, match=r"must be a trilobe\.Brdf"):
        plot.factors(3)


def test_save_keeps_another_model(tmp_path):
    results = [
        trilobe.fit("synth:felt@12x12x24", solver="awls", max_iterations=1, lobes=n, progress=False) for n in (1, 2)
    ]
    results[0].save(tmp_path)
    results[0].save(tmp_path)
    assert not (tmp_path / "model.previous.json").exists()
    results[1].save(tmp_path)
    assert trilobe.load(tmp_path / "model.json").lobes == 2
    assert trilobe.load(tmp_path / "model.previous.json").lobes == 1


@pytest.mark.parametrize("name", ["model.json", "trace.csv", "report.json"])
def test_save_leaves_files_of_others(fitted, tmp_path, name):
    (tmp_path / name).write_text('{"tool": "another"}')
    with pytest.raises(trilobe.Error, match=f"{name}' exists, and Trilobe has not written it"):
        fitted.save(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == '{"tool": "another"}'
    fitted.save(tmp_path, force=True)
    fitted.save(tmp_path)
    assert trilobe.load(tmp_path / "model.json").lobes == 3
