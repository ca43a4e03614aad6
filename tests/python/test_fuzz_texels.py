"""The same of what is drawn, saved, weighed and fitted by texel: no argument whatever ends the interpreter."""

import os

import numpy as np
import pytest

import trilobe

from models import directions
from test_fuzz import CALLS, MODELS, TINY, anything, arrays, has_fits, holds, numbers, settings

hypothesis = pytest.importorskip("hypothesis")
st = pytest.importorskip("hypothesis.strategies")

pytestmark = pytest.mark.skipif(not has_fits(), reason="only what evaluates is built")
SAMPLES = 4
PAIR = directions(SAMPLES, 1), directions(SAMPLES, 2)


@st.composite
def texels(draw):
    """Values, most of them nearly right."""
    shape = draw(st.sampled_from([(0, SAMPLES, 3), (5, SAMPLES, 3), (2, 3, SAMPLES, 3), (1, 0, SAMPLES, 3), (3, 1, 3)]))
    rho = np.random.default_rng(draw(st.integers(0, 99))).lognormal(0, 3, shape).astype(draw(st.sampled_from("fd")))
    if rho.size:
        rho.flat[draw(st.integers(0, rho.size - 1))] = draw(st.floats(width=32))
    order = draw(st.integers(0, 2))
    return np.asfortranarray(rho) if order == 1 else rho[::-1] if order == 2 else rho


pairs = st.one_of(st.just(PAIR), st.just(PAIR), st.tuples(anything, anything), anything)
shared = st.one_of(st.lists(st.sampled_from(MODELS), max_size=7), st.sampled_from(MODELS), anything)
options = st.fixed_dictionaries({}, optional={
    "coloured": st.one_of(st.booleans(), anything), "weighting": st.sampled_from(["log", "uniform", "power:", 3, None]),
    "threads": st.one_of(st.integers(-1, 3), anything), "shard": st.one_of(st.tuples(numbers, numbers), anything),
    "anisotropic": numbers, "out": st.sampled_from(["a", "b", "c/d", "file", "", "nul\0", 3, None]),
    "unheard_of": anything,
})


@settings
@hypothesis.given(pairs, st.one_of(texels(), texels(), texels(), arrays(), anything), shared, options)
def test_fits_any_texels(tmp_path_factory, directions, rho, shared, options):
    here = tmp_path_factory.getbasetemp() / "texels"
    here.mkdir(exist_ok=True)
    (here / "file").touch()
    os.chdir(here)
    if isinstance(shared, (int, np.integer)):
        options = {**options, "unheard_of": 1}  # or it would take seconds to find them
    try:
        fitted = trilobe.fit_texels(directions, rho, shared, progress=False, **options)
    except trilobe.Error as error:
        assert "\n" not in str(error)
        return
    if fitted is None:
        return
    assert fitted.d.shape == (*fitted.shape, 3) and len(fitted.s) == len(fitted.materials)
    for array in (fitted.d, fitted.error, *fitted.s):
        assert np.isfinite(array).all() and (array >= 0).all()
    holds(lambda: fitted.eval([0, 0, 1], [0, 0.6, 0.8]))


FEW = trilobe.fit_texels(PAIR, np.ones((2, 3, SAMPLES, 3)), MODELS[:2], progress=False) if has_fits() else None


@settings
@hypothesis.given(anything, anything)
def test_evaluates_texels_anywhere(wi, wo):
    holds(lambda: FEW.eval(wi, wo), wi, wo, shape=(2, 3))


@settings
@hypothesis.given(st.integers(0, 10**6), st.integers(0, 255), st.sampled_from(
    ["texels.json", "d.exr", "s0.exr", "materials/1.json"]), st.one_of(st.none(), st.binary(max_size=40)))
def test_loads_any_folder_of_texels(tmp_path_factory, place, byte, name, other):
    folder = tmp_path_factory.getbasetemp() / "saved"
    if not folder.exists():
        FEW.save(folder)
    good = (folder / name).read_bytes()
    bad = bytearray(good)
    bad[place % len(bad)] = byte
    (folder / name).write_bytes(bad if other is None else other)
    try:
        loaded = trilobe.load_texels(folder)
        loaded.eval([0, 0, 1], [0, 0, 1])
    except trilobe.Error as error:
        assert "\n" not in str(error)
    finally:
        (folder / name).write_bytes(good)


@settings
@hypothesis.given(st.one_of(numbers, st.lists(numbers, max_size=2)))
def test_loads_texels_of_any_path(path):
    with pytest.raises(trilobe.Error):
        trilobe.load_texels(path)


@hypothesis.settings(settings, max_examples=max(CALLS // 10, 20))  # each draws a picture
@hypothesis.given(st.sampled_from(["factors", "slices", "spheres", "trace"]), st.one_of(
    st.sampled_from(MODELS), anything), st.one_of(st.just(TINY), anything), anything)
def test_draws_anything(how, model, measurement, figure):
    pytest.importorskip("matplotlib").use("agg")
    from matplotlib import pyplot

    more = {"factors": {"uncertainty": measurement}, "trace": {}}.get(how, {"measurement": measurement})
    try:
        getattr(trilobe.plot, how)(model, figure=figure, **more)
    except trilobe.Error as error:
        assert "\n" not in str(error)
    finally:
        pyplot.close("all")


@settings
@hypothesis.given(st.one_of(st.just(lambda wi, wo, rho: np.ones(len(rho))), st.just(lambda *given: None), anything))
def test_weighs_by_anything(weights):
    holds(lambda: trilobe.Objective(TINY, weights=weights).value(np.zeros(3)))


@settings
@hypothesis.given(st.one_of(st.sampled_from(["a.csv", "b.binary", "c.bin", "d", "", "no/where.csv", "nul\0.csv"]),
                            st.integers(), st.none(), st.floats(), st.dates()))
def test_saves_to_anything(tmp_path_factory, path):
    os.chdir(tmp_path_factory.getbasetemp())
    holds(lambda: TINY.save(path))
    holds(lambda: MODELS[0].save(path))
