"""No argument whatever ends the interpreter: each call returns, or raises Error in one line.

TRILOBE_FUZZ_CALLS says how many calls of each function there are; CI makes few.
"""

import os

import numpy as np
import pytest

import trilobe
from trilobe._model.arrays import of_one_precision

from models import anisotropic, directions, independent, isotropic, lambertian, stretched

hypothesis = pytest.importorskip("hypothesis")
st = pytest.importorskip("hypothesis.strategies")
hnp = pytest.importorskip("hypothesis.extra.numpy")

CALLS = int(os.environ.get("TRILOBE_FUZZ_CALLS", "60"))
settings = hypothesis.settings(
    max_examples=CALLS, deadline=None, database=None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
MODELS = [make() for make in (isotropic, anisotropic, independent, stretched, lambertian)]

numbers = st.one_of(
    st.floats(), st.integers(), st.booleans(), st.complex_numbers(), st.text(max_size=5),
    st.none(), st.binary(max_size=5), st.dates(),
)
dtypes = st.sampled_from(["f2", "f4", "f8", ">f8", "i1", "i8", "u2", "?", "c8", "S3", "O"])


@st.composite
def arrays(draw):
    """Arrays of any dtype, shape and memory order, most of them nearly right."""
    nearly = st.sampled_from([(3,), (1, 3), (4, 3), (2, 4, 3), (0, 3), (2,), (4, 2), (90,), (3, 90)])
    shape = draw(st.one_of(nearly, hnp.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4)))
    dtype = draw(st.one_of(st.sampled_from(["f4", "f8"]), dtypes))
    if draw(st.booleans()) and dtype in ("f4", "f8"):
        array = np.random.default_rng(draw(st.integers(0, 99))).normal(size=shape).astype(dtype)
    else:
        with np.errstate(all="ignore"):
            array = draw(hnp.arrays(dtype, shape) if dtype != "O"
                         else st.just(np.full(shape, None, object)))
    how = draw(st.integers(0, 5))
    if how == 1:
        array = np.asfortranarray(array)
    elif how == 2:
        array.flags.writeable = False
    elif how == 3 and array.ndim > 0:
        array = array[::-1]
    elif how == 4:
        array = np.broadcast_to(array, (2, *array.shape))
    elif how == 5:
        array = np.repeat(array, 2, axis=-1)[..., ::2] if array.ndim > 0 else array
    return array


anything = st.one_of(arrays(), arrays(), arrays(), numbers, st.lists(numbers, max_size=4),
                     st.lists(st.lists(st.floats(), max_size=3), max_size=3))
models = st.sampled_from(MODELS)


def holds(call, *directions, u=None, shape=()):
    """Calls, and looks at what is raised or returned: NaN where one of the directions is none, and there alone.

    Random numbers `u` and a shape broadcast with the directions.
    """
    try:
        result = call()
    except trilobe.Error as error:
        assert str(error) and "\n" not in str(error)
        return
    none = np.zeros((), bool)
    if directions:
        given = {str(k): w for k, w in enumerate(directions)} | ({} if u is None else {"u": u})
        arrays = of_one_precision(**given)
        none = np.zeros(np.broadcast_shapes(shape, *(array.shape[:-1] for array in arrays)), bool)
        for w in arrays[: len(directions)]:
            none |= ~np.isfinite(w).all(axis=-1) | (w == 0).all(axis=-1)
    for array in result if isinstance(result, tuple) else (result,):
        if isinstance(array, np.ndarray):
            assert array.dtype in (np.float32, np.float64)
            wanted = none.reshape(none.shape + (1,) * (array.ndim - none.ndim))
            assert np.array_equal(np.isnan(array), np.broadcast_to(wanted, array.shape))


@settings
@hypothesis.given(models, anything, anything, st.booleans())
def test_evaluates_anything(brdf, wi, wo, components):
    holds(lambda: brdf.eval(wi, wo, components=components), wi, wo)
    holds(lambda: brdf.eval_cos(wi, wo), wi, wo)
    holds(lambda: brdf.pdf(wi, wo), wi, wo)


@settings
@hypothesis.given(models, anything, anything)
def test_samples_anything(brdf, wi, u):
    holds(lambda: brdf.sample(wi, u), wi, u=u)
    holds(lambda: brdf.albedo(wi), wi)


@settings
@hypothesis.given(models, st.dictionaries(
    st.sampled_from(["d", "s", "D", "F", "G", "stretch", "like"]), anything, max_size=3))
def test_edits_by_anything(brdf, parts):
    def edit():
        if "like" in parts:
            whole = {name: getattr(brdf, name) for name in "dsDFG"}
            return trilobe.Brdf(**{**whole, **parts})
        return brdf.replace(**parts)

    try:
        edited = edit()
    except trilobe.Error as error:
        assert "\n" not in str(error)
        return
    holds(lambda: edited.eval(directions(3, 1), directions(3, 2)))


@settings
@hypothesis.given(models, st.integers(0, 10**6), st.integers(0, 127), st.one_of(
    st.none(), st.binary(max_size=40), st.text(max_size=40)))
def test_reads_anything(brdf, place, letter, other):
    text = brdf.to_json()
    place %= len(text)
    changed = text[:place] + chr(letter) + text[place + 1:] if other is None else other
    try:
        trilobe.Brdf.from_json(changed).albedo([0, 0, 1])
    except trilobe.Error as error:
        assert "\n" not in str(error)


@settings
@hypothesis.given(st.one_of(numbers, st.lists(numbers, max_size=2)))
def test_loads_anything(path):
    with pytest.raises(trilobe.Error):
        trilobe.load(path)


def has_fits():
    try:
        import trilobe._fit  # noqa: F401
    except ImportError:
        return False
    return True


needs_fits = pytest.mark.skipif(not has_fits(), reason="only what evaluates is built")


@needs_fits
@settings
@hypothesis.given(anything, anything, anything, st.one_of(st.none(), st.booleans(), numbers),
                  st.dictionaries(st.sampled_from(["max_angle", "min_theta_d", "source"]), numbers, max_size=1))
def test_measures_anything(wi, wo, rho, anisotropic, others):
    try:
        measurement = trilobe.Measurement(wi, wo, rho, anisotropic=anisotropic, **others)
    except trilobe.Error as error:
        assert "\n" not in str(error)
        return
    counts = measurement.counts
    assert counts["valid"] == len(measurement.rho) == len(measurement.wi)
    assert np.isfinite(measurement.wi).all() and (measurement.rho >= 0).all()


@needs_fits
@settings
@hypothesis.given(st.one_of(numbers, st.sampled_from(["synth:plastic@4x4x8", "synth:felt@3x4", "synth:shot_silk@3x4"])),
                  st.dictionaries(st.sampled_from(["noise", "missing", "seed", "max_angle", "min_theta_d",
                                                   "extrapolated", "radiometry", "columns", "theta_i",
                                                   "bands", "threads"]), anything, max_size=2))
def test_reads_any_source(source, options):
    try:
        measurement = trilobe.read(source, **options)
        measurement.valid.sum(), measurement.reason.max(initial=0)
    except trilobe.Error as error:
        assert "\n" not in str(error)


FIT_OPTIONS = ["model", "solver", "lobes", "stretch", "d_nodes", "g_nodes", "f_bins", "nodes", "init", "start",
               "weighting", "prior", "robust", "smoothness", "match_reflectance", "raw", "max_parameters", "seed",
               "threads", "max_iterations", "max_seconds", "tolerance", "g_filter", "memory", "starts", "weights",
               "callback", "stop", "unheard_of"]
names = st.sampled_from(["auto", "awls", "lm", "independent", "isotropic", "anisotropic", "moments", "log", "held_out",
                         "6x8", "4rx4"])


@needs_fits
@hypothesis.settings(settings, max_examples=max(CALLS // 10, 20))  # each takes some 50 ms
@hypothesis.given(st.dictionaries(st.sampled_from(FIT_OPTIONS), st.one_of(names, anything), max_size=3))
def test_fits_by_any_option(options):
    options = {"solver": "awls", "max_seconds": 0.05, **options, "progress": False}
    options["max_iterations"] = options.get("max_iterations", 1)
    if isinstance(options["max_iterations"], int):
        options["max_iterations"] = min(options["max_iterations"], 1)
    try:
        result = trilobe.fit(TINY, **options)
    except trilobe.Error as error:
        assert "\n" not in str(error)
        return
    holds(lambda: result.model.eval([0, 0, 1], [0, 0, 1]))


@needs_fits
@settings
@hypothesis.given(st.one_of(st.sampled_from(["covariance", "bootstrap"]), anything),
                  st.dictionaries(st.sampled_from(["replicates", "blocks", "seed"]), anything, max_size=2))
def test_is_uncertain_by_any_option(method, options):
    if isinstance(options.get("replicates"), int):
        options["replicates"] = min(options["replicates"], 3)  # each takes time
    holds(lambda: FITTED.uncertainty(method, **{"replicates": 2, **options}))


TINY = trilobe.read("synth:plastic@6x6x12") if has_fits() else None
FITTED = trilobe.fit(TINY, progress=False, solver="awls", max_iterations=1) if has_fits() else None
