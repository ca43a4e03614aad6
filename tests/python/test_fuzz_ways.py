"""The same of objectives, files, reports, tables of other libraries and tensors: no argument ends the interpreter."""

import os
import pickle

import numpy as np
import pytest

import trilobe

from test_fuzz import CALLS, FITTED, MODELS, TINY, anything, has_fits, holds, models, numbers, settings

hypothesis = pytest.importorskip("hypothesis")
st = pytest.importorskip("hypothesis.strategies")
hnp = pytest.importorskip("hypothesis.extra.numpy")

pytestmark = pytest.mark.skipif(not has_fits(), reason="only what evaluates is built")

OBJECTIVES = [trilobe.Objective(TINY), trilobe.Objective(TINY, like=MODELS[2])] if has_fits() else []
paths = st.one_of(st.sampled_from(["", ".", "a", "no/where", "nul\0", "file/x", "\udc80"]), numbers)


@st.composite
def vectors(draw):
    """Parameters, most of them of the right number."""
    x = OBJECTIVES[0].start() * draw(st.sampled_from([1.0, 0.0, 1e-300, 1e150, 1e300, -1.0]))
    for value in draw(st.lists(st.floats(), max_size=3)):
        x[draw(st.integers(0, len(x) - 1))] = value
    with np.errstate(over="ignore"):
        return x[: draw(st.sampled_from([len(x), len(x), len(x), 0, 5]))].astype(draw(st.sampled_from("fdd")))


@settings
@hypothesis.given(st.sampled_from(OBJECTIVES), st.one_of(vectors(), vectors(), anything), st.sampled_from(
    ["value", "value_and_gradient", "gradient", "normal_equations", "hessian", "residuals", "jacobian", "project"]))
def test_objectives_at_anything(E, x, what):
    try:
        found = getattr(E, what)(x)
    except trilobe.Error as error:
        assert str(error) and "\n" not in str(error)
        return
    if what == "project":
        assert (found >= 0).all() and np.isfinite(found).all()
    # E overflows where products of entries do.
    moderate = np.abs(np.asarray(x, float)).max(initial=0) < 1e20
    for array in found if isinstance(found, tuple) else (found,):
        assert not moderate or np.isfinite(array.data if what == "jacobian" else array).all()


@settings
@hypothesis.given(st.sampled_from(OBJECTIVES), st.one_of(vectors(), anything), anything)
def test_models_of_anything(E, x, solver):
    holds(lambda: E.model(x, solver).eval([0, 0, 1], [0.6, 0, 0.8]))


@settings
@hypothesis.given(st.sampled_from(OBJECTIVES), st.one_of(models, anything, st.sampled_from(["random", "moments"])),
                  st.one_of(st.integers(), anything))
def test_starts_anywhere(E, init, seed):
    holds(lambda: E.start(init, seed))


@settings
@hypothesis.given(st.one_of(st.just(TINY), st.just(TINY), anything), st.dictionaries(st.sampled_from(
    ["model", "lobes", "stretch", "d_nodes", "g_nodes", "f_bins", "weighting", "weights", "threads", "like"]),
    st.one_of(anything, models, st.sampled_from(["isotropic", "anisotropic", "6x8", "power:1"])), max_size=3))
def test_objectives_of_anything(measurement, options):
    if isinstance(measurement, (str, bytes)):
        return  # a path, which may be there
    holds(lambda: trilobe.Objective(measurement, **options).value([1.0]))


devices = st.dictionaries(st.sampled_from(["theta_max", "in_plane", "incidences", "step", "blind"]),
                          st.one_of(anything, st.floats(0, 89), st.booleans(), st.lists(st.floats(0, 80))), max_size=3)


@settings
@hypothesis.given(st.one_of(st.integers(1, 99), anything), devices, anything)
def test_directions_of_anything(count, device, rows):
    def some():
        plan = trilobe.directions_to_measure(count, **device)
        assert len(plan) == count and np.isfinite(plan.angles).all()
        try:
            return plan[rows].wi
        except (IndexError, TypeError):
            return plan.wo

    holds(some)
    holds(lambda: trilobe.Directions(rows).wi)


@settings
@hypothesis.given(st.one_of(st.just(TINY), paths, anything), st.one_of(st.integers(1, 9), anything), devices,
                  st.dictionaries(st.sampled_from(["by", "threads", "progress"]),
                                  st.one_of(anything, st.sampled_from(["plan", "both"])), max_size=2))
def test_next_directions_of_anything(measured, count, device, options):
    holds(lambda: trilobe.next_directions(measured, count, **device, **options))


@settings
@hypothesis.given(st.one_of(models, st.just(TINY), anything), st.one_of(
    st.sampled_from(["a.csv", "a.glsl", "a.hlsl", "a.unknown"]), paths), st.dictionaries(
        st.sampled_from(["error", "spectral", "threads"]), anything, max_size=2))
def test_converts_anything(tmp_path_factory, what, path, options):
    os.chdir(tmp_path_factory.getbasetemp())
    holds(lambda: trilobe.convert(what, path, **options))
    assert not [name for name in os.listdir(".") if name.startswith(".trilobe")]


@pytest.mark.skipif(CALLS < 60, reason="takes long")
@hypothesis.settings(settings, max_examples=max(CALLS // 10, 1))  # some take a second
@hypothesis.given(st.one_of(models, st.just(TINY)), st.sampled_from(
    ["a.bsdf", "a.mtlx", "a.principled.json", "a.gltf", "a.usda", "a.zemax.bsdf", "a.xml", "a.binary", "a.bin",
     "a.xompt"]),
    st.fixed_dictionaries({}, optional={"error": st.floats(), "spectral": st.booleans(), "threads": st.integers()}))
def test_converts_for_renderers(tmp_path_factory, what, path, options):
    os.chdir(tmp_path_factory.getbasetemp())
    holds(lambda: trilobe.convert(what, path, **options))


@settings
@hypothesis.given(st.one_of(models, anything), st.one_of(st.just(TINY), anything), st.fixed_dictionaries(
    {}, optional={"weighting": st.one_of(st.sampled_from(["log", "power:2"]), anything), "threads": anything}))
def test_scores_anything(model, measurement, options):
    if isinstance(model, (str, bytes)) or isinstance(measurement, (str, bytes)):
        return  # paths, which may be there
    holds(lambda: trilobe.score(model, measurement, **options))


@settings
@hypothesis.given(paths, st.sampled_from(["result", "model", "texels", "measurement"]))
def test_writes_to_anything(tmp_path_factory, path, what):
    here = tmp_path_factory.getbasetemp() / "written"
    here.mkdir(exist_ok=True)
    os.chdir(here)
    (here / "file").touch()
    if isinstance(path, str) and path in ("", "."):
        path = here / "more"
    holds(lambda: {"result": FITTED, "model": MODELS[0], "texels": FEW, "measurement": TINY}[what].save(path))


@settings
@hypothesis.given(st.one_of(hnp.arrays("f8", (5, 3)), st.just(np.ones((5, 3)))), hnp.arrays("f8", (5, 3)),
                  hnp.arrays(st.sampled_from(["f4", "f8"]), st.sampled_from([(5,), (5, 1), (5, 3)])))
def test_tables_of_any_measurement(wi, wo, rho):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    try:
        measurement = trilobe.Measurement(wi, wo, rho)
    except trilobe.Error as error:
        assert "\n" not in str(error)
        return
    frame, data = measurement.to_pandas(), measurement.to_xarray()
    assert isinstance(frame, pandas.DataFrame) and isinstance(data, xarray.Dataset)
    assert len(frame) == data.sizes["sample"] == len(measurement.rho) and not frame.isna().any(axis=None)
    again = pickle.loads(pickle.dumps(measurement))
    assert again.counts == measurement.counts and np.array_equal(again.wi, measurement.wi)


@settings
@hypothesis.given(models, st.one_of(anything, st.sampled_from("DFG")), anything, anything)
def test_other_questions_to_a_model(brdf, factor, wi, wo):
    holds(lambda: brdf.unobserved(factor).astype(float))
    holds(lambda: brdf.spectrum(wi, wo), wi, wo)
    assert isinstance(factor, np.ndarray) or not brdf == factor


def _raised(call):
    """Calls; what is raised is an Error, or PyTorch's own of tensors that it does not compute with."""
    try:
        return call()
    except trilobe.Error as error:
        assert str(error) and "\n" not in str(error)
    return None


@settings
@hypothesis.given(models, anything, anything, st.dictionaries(
    st.sampled_from(["d", "s", "D", "F", "G", "H"]), anything, max_size=2), st.booleans())
def test_tensors_of_anything(brdf, wi, wo, parts, tensors):
    torch = pytest.importorskip("torch")

    def tensor(value):
        try:
            return torch.tensor(value) if tensors else value
        except (TypeError, ValueError, RuntimeError, OverflowError):
            return value

    f = _raised(lambda: trilobe.torch.eval(brdf, tensor(wi), tensor(wo), **{k: tensor(v) for k, v in parts.items()}))
    if f is not None and not parts:
        pair = [tensor(w).to(f.dtype) for w in (wi, wo)]
        none = [~w.isfinite().all(dim=-1) | (w == 0).all(dim=-1) for w in pair]
        assert torch.equal(f.isnan(), (none[0] | none[1])[..., None].expand(f.shape))


@settings
@hypothesis.given(st.one_of(models, anything), st.fixed_dictionaries({}, optional={
    "texels": st.one_of(st.integers(-1, 3), anything),
    "shared": st.one_of(st.sampled_from(["DFG", "ds", ""]), anything),
    "dtype": st.one_of(st.sampled_from(["float32", "int8", "complex64", "bool"]), anything)}),
    st.one_of(st.none(), st.integers(-4, 4), anything))
def test_modules_of_anything(brdf, options, texel):
    torch = pytest.importorskip("torch")
    if isinstance(options.get("dtype"), str) and hasattr(torch, options["dtype"]):
        options["dtype"] = getattr(torch, options["dtype"])
    if isinstance(options.get("texels"), int):
        options["texels"] = min(options["texels"], 3)  # each takes memory
    model = _raised(lambda: trilobe.torch.Model(brdf, **options))
    if model is not None:
        holds(lambda: model.brdf(texel).eval([0, 0, 1], [0.6, 0, 0.8]))


@hypothesis.settings(settings, max_examples=max(CALLS // 10, 10))  # each starts the program
@hypothesis.given(st.one_of(st.just("synth:plastic@6x6x12"), st.lists(st.one_of(paths, st.just("synth:felt@3x4")))),
                  paths, st.fixed_dictionaries({}, optional={
                      "workers": anything, "program": paths, "solver": anything, "max_iterations": st.integers(0, 1),
                      "un heard": anything}))
def test_batches_of_anything(tmp_path_factory, sources, out, options):
    here = tmp_path_factory.getbasetemp() / "batches"
    here.mkdir(exist_ok=True)
    os.chdir(here)
    if isinstance(sources, list) and any(str(source) in (".", "") for source in sources):
        return  # all that is there
    holds(lambda: trilobe.fit_many(sources, out, **{"max_iterations": 0, **options}))


FEW = trilobe.fit_texels(([[0, 0, 1]], [[0.6, 0, 0.8]]), np.ones((2, 3, 1, 3)), MODELS[:1], progress=False) \
    if has_fits() else None
