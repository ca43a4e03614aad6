"""Models over arrays: values, sampling, tables, files, and what is told of bad arguments."""

import copy
import json
import pickle
import subprocess
import sys
import threading
import warnings

import numpy as np
import pytest

import trilobe
from trilobe._model.error import in_keywords

from models import anisotropic, directions, independent, isotropic, lambertian, literal, stretched

ALL = [isotropic, anisotropic, independent, stretched, lambertian]


@pytest.mark.parametrize("make", ALL)
def test_equals_the_formula(make):
    brdf = make()
    wi, wo = directions(300, 1), directions(300, 2)
    wanted = literal(brdf, wi, wo)
    np.testing.assert_allclose(brdf.eval(wi, wo), wanted, rtol=1e-8, atol=1e-12)
    single = brdf.eval(wi.astype(np.float32), wo.astype(np.float32))
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, wanted, rtol=5e-3, atol=1e-4)


@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_its_parts_agree(make, dtype):
    brdf = make()
    wi, wo = directions(200, 3).astype(dtype), directions(200, 4).astype(dtype)
    close = {"rtol": 2e-3 if dtype == np.float32 else 1e-9, "atol": 1e-6}
    f = brdf.eval(wi, wo)
    parts = brdf.eval(wi, wo, components=True)
    assert parts.shape == (200, 1 + brdf.lobes, 3)
    np.testing.assert_allclose(np.maximum(parts.sum(axis=-2), 0), f, **close)
    np.testing.assert_allclose(brdf.eval_cos(wi, wo), f * wo[:, 2:], **close)
    np.testing.assert_allclose(brdf.eval(wo, wi), f, **close)
    drawn = brdf.sample(wi, np.random.default_rng(5).random((200, 2)).astype(dtype))
    there = drawn.pdf > 0
    assert there.mean() > 0.98
    np.testing.assert_allclose(brdf.pdf(wi, drawn.wo)[there], drawn.pdf[there], rtol=0.02)
    np.testing.assert_allclose(
        (brdf.eval_cos(wi, drawn.wo) / drawn.pdf[:, None])[there], drawn.weight[there], rtol=0.02
    )


def spectral():
    """A model of seven wavelengths."""
    brdf, rng = isotropic(), np.random.default_rng(7)
    text = json.loads(brdf.to_json())
    text.update(version=3, wavelengths=[400, 450, 500, 550, 600, 650, 700], d=(0.1 * rng.random(7)).tolist(),
                s=rng.random((3, 7)).tolist(), F=(0.5 + rng.random((7, 90))).tolist())
    return trilobe.Brdf.from_json(json.dumps(text))


def test_a_spectral_model_has_the_values_of_its_wavelengths():
    brdf, rng = isotropic(), np.random.default_rng(7)
    text = json.loads(brdf.to_json())
    wavelengths = [400, 450, 500, 550, 600, 650, 700]
    d, s, F = 0.1 * rng.random(7), rng.random((3, 7)), 0.5 + rng.random((7, 90))
    text.update(version=3, wavelengths=wavelengths, d=d.tolist(), s=s.tolist(), F=F.tolist())
    text.pop("unobserved", None)
    spectral = trilobe.Brdf.from_json(json.dumps(text))
    np.testing.assert_array_equal(spectral.wavelengths, wavelengths)
    wi, wo = directions(100, 8), directions(100, 9)
    values = pickle.loads(pickle.dumps(spectral)).spectrum(wi, wo)
    assert values.shape == (100, 7)
    three = trilobe.Brdf(d[2:5], s[:, 2:5], brdf.D, F[2:5], brdf.G)
    np.testing.assert_allclose(values[:, 2:5], three.eval(wi, wo), rtol=1e-9, atol=1e-12)
    assert not spectral.spectrum([0, 0, -1], wo).any()

    text.update(d=[0.1] * 7, s=[[0.2] * 7] * 3, F=[F[0].tolist()] * 7)  # grey
    grey = trilobe.Brdf.from_json(json.dumps(text))
    np.testing.assert_allclose(grey.eval(wi, wo), grey.spectrum(wi, wo)[:, :3], rtol=1e-9)

    assert brdf.wavelengths.size == 0
    with pytest.raises(trilobe.Error, match="no wavelengths"):
        brdf.spectrum(wi, wo)


def test_albedo_is_the_mean_weight():
    brdf = isotropic()
    for cosine in (1, 0.5):
        wi = [np.sqrt(1 - cosine**2), 0, cosine]
        weight = brdf.sample(wi, np.random.default_rng(6).random((40000, 2))).weight
        np.testing.assert_allclose(weight.mean(axis=0), brdf.albedo(wi), rtol=0.03)


def reflected(brdf, wi, rows=500, columns=384):
    """The albedo by midpoints of the root of theta_h and of azimuths about wi's up to which wo is above the surface."""
    cos_i, sin_i = wi[2], np.hypot(wi[0], wi[1])
    x = (np.arange(rows) + 0.5) / rows
    theta = x**2 * np.pi / 2
    cos_h, sin_h = np.cos(theta)[:, None], np.sin(theta)[:, None]
    widest = np.arccos(np.clip(-cos_i * (2 * cos_h**2 - 1) / np.maximum(2 * sin_h * cos_h * sin_i, 1e-300), -1, 1))
    phi = ((np.arange(columns) + 0.5) / columns * 2 - 1) * widest
    wi_h = cos_i * cos_h + sin_i * sin_h * np.cos(phi)
    along, across = 2 * wi_h * sin_h * np.cos(phi) - sin_i, 2 * wi_h * sin_h * np.sin(phi)
    x_i, y_i = (wi[0] / sin_i, wi[1] / sin_i) if sin_i > 1e-9 else (1, 0)
    wo = np.stack([along * x_i - across * y_i, along * y_i + across * x_i, 2 * wi_h * cos_h - cos_i], axis=-1)
    lobes = brdf.eval(wi, wo) - np.where(wo[..., 2:] > 0, np.asarray(brdf.d), 0)
    # dω_o = 4 (wi . h) sin theta_h dtheta_h dphi, theta_h = x^2 90 degrees.
    by_angles = lobes * (np.maximum(wo[..., 2], 0) * 4 * wi_h)[..., None]
    of_rows = by_angles.mean(axis=1) * 2 * widest * sin_h * (np.pi * x / rows)[:, None]
    return of_rows.sum(axis=0) + np.pi * np.asarray(brdf.d)


@pytest.mark.parametrize("name", ["charmeuse", "linen"])
def test_albedo_of_anisotropic_models_is_within_half_a_percent(name):
    """Where G has kinks, and between azimuths of the tables, too."""
    brdf, rng = trilobe.load(f"material:{name}"), np.random.default_rng(7)
    for theta in np.radians([0, 10, 30, 45, 60, 68, 72, 75, 78, 80, 83, 85, 87, 88.5, 89.3]):
        for phi in 2 * np.pi * rng.random(2):
            wi = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
            np.testing.assert_allclose(brdf.albedo(wi), reflected(brdf, wi), rtol=5e-3, err_msg=f"{theta} {phi}")


def test_broadcasts_like_numpy():
    brdf = isotropic()
    wi, wo = directions(4, 7).reshape(4, 1, 3), directions(5, 8).reshape(1, 5, 3)
    f = brdf.eval(wi, wo)
    assert f.shape == (4, 5, 3)
    np.testing.assert_array_equal(f[2, 3], brdf.eval(wi[2, 0], wo[0, 3]))
    assert brdf.eval([0, 0, 1], wo).shape == (1, 5, 3)
    assert brdf.pdf([0, 0, 1], [0, 0, 1]).shape == ()
    assert brdf.eval(np.empty((0, 3)), wo[0, :1]).shape == (0, 3)
    assert brdf.sample(wi, np.full((1, 5, 2), 0.5)).weight.shape == (4, 5, 3)
    assert brdf.albedo(wi).shape == (4, 1, 3)


def test_takes_arrays_as_they_lie():
    brdf = isotropic()
    wi, wo = directions(64, 9), directions(64, 10)
    f = brdf.eval(wi, wo)
    frozen = wi.copy()
    frozen.flags.writeable = False
    np.testing.assert_array_equal(brdf.eval(frozen, wo), f)
    np.testing.assert_array_equal(brdf.eval(np.asfortranarray(wi), wo), f)
    np.testing.assert_array_equal(brdf.eval(wi[::-2], wo[::-2]), f[::-2])
    np.testing.assert_array_equal(brdf.eval(wi.astype(">f8"), wo.tolist()), f)
    # Half precision and integers.
    assert brdf.eval(wi.astype(np.float16), wo.astype(np.float32)).dtype == np.float32
    np.testing.assert_array_equal(brdf.eval(np.array([0, 0, 1]), [0, 0, 1]),
                                  brdf.eval([0.0, 0, 1], [0.0, 0, 1]))


class Exported:
    """Something of another library, which has no more than DLPack."""

    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **options):
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._array.__dlpack_device__()


class Elsewhere(Exported):
    """An array in the memory of a GPU."""

    def __dlpack__(self, **options):
        raise BufferError("cannot export a tensor of cuda:0 to the CPU")

    def __dlpack_device__(self):
        return (2, 0)


def test_takes_dlpack():
    brdf = isotropic()
    wi, wo = directions(8, 11), directions(8, 12)
    np.testing.assert_array_equal(brdf.eval(Exported(wi), Exported(wo)), brdf.eval(wi, wo))
    with pytest.raises(trilobe.Error, match="wo cannot be read as an array in the CPU's memory"):
        brdf.eval(wi, Elsewhere(wo))


def everything(brdf, w, dtype):
    """What all methods say of a direction, beside one that is right."""
    up, w = np.array([0, 0, 1], dtype), np.array(w, dtype)
    for pair in ((w, up), (up, w)):
        yield from (brdf.eval(*pair), brdf.eval(*pair, components=True), brdf.eval_cos(*pair), brdf.pdf(*pair))
        if brdf.wavelengths.size > 0:
            yield brdf.spectrum(*pair)
    yield brdf.albedo(w)
    yield from brdf.sample(w, np.array([0.3, 0.4], dtype))


@pytest.mark.parametrize("make", [*ALL, spectral])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_is_zero_where_there_is_no_light(make, dtype):
    for w in ([0, 0, -1], [1, 0, 0], [1, 0, -1e-6]):
        for value in everything(make(), w, dtype):
            assert (value == 0).all()


@pytest.mark.parametrize("make", [*ALL, spectral])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_is_nan_of_what_is_no_direction(make, dtype):
    brdf = make()
    for w in ([0, 0, 0], [np.nan, 0, 1], [0, 0, np.nan], [np.inf, 0, 1], [0, 0, -np.inf], [np.inf, np.nan, 1]):
        for value in everything(brdf, w, dtype):
            assert np.isnan(value).all()
    # The rows beside it are as they are alone.
    wi, wo = directions(300, 1).astype(dtype), directions(300, 2).astype(dtype)
    f, pdf = brdf.eval(wi, wo), brdf.pdf(wi, wo)
    wi[7], wo[280] = np.nan, 0
    kept = np.delete(np.arange(300), [7, 280])
    np.testing.assert_array_equal(brdf.eval(wi, wo)[kept], f[kept])
    np.testing.assert_array_equal(brdf.pdf(wi, wo)[kept], pdf[kept])
    assert np.isnan(brdf.eval(wi, wo)[[7, 280]]).all()


@pytest.mark.parametrize("u", [1, -1e-9, 1.5, np.nan, np.inf])
def test_refuses_random_numbers_that_are_none(u):
    brdf = isotropic()
    numbers = np.full((300, 2), 0.5)
    numbers[290, 1] = u
    for dtype in (np.float32, np.float64):
        with pytest.raises(trilobe.Error, match="from 0 to below 1") as caught:
            brdf.sample([0, 0, 1], numbers.astype(dtype))
        assert (caught.value.kind, caught.value.key) == ("range", "u")
        last = np.nextafter(dtype(1), dtype(0))
        assert (brdf.sample(np.array([0, 0, 1], dtype), np.array([0, last], dtype)).pdf > 0).all()


def test_directions_need_not_be_unit_vectors():
    brdf = isotropic()
    wi, wo = directions(20, 13), directions(20, 14)
    f = brdf.eval(wi, wo)
    for scale in (3, 1e-200, 1e200):
        np.testing.assert_allclose(brdf.eval(wi * scale, wo), f, rtol=1e-9)


@pytest.mark.parametrize("make", ALL)
def test_goes_through_a_file(make, tmp_path):
    brdf = make()
    path = tmp_path / "model.json"
    brdf.save(path)
    for other in (trilobe.load(path), trilobe.load(tmp_path), trilobe.load(str(path)),
                  copy.deepcopy(brdf), pickle.loads(pickle.dumps(brdf)), brdf.replace()):
        assert other == brdf
    assert [name.name for name in tmp_path.iterdir()] == ["model.json"]


def test_files_of_other_formats_are_left_to_others(tmp_path):
    path = tmp_path / "model.glsl"
    with pytest.raises(trilobe.Error, match=r"format \.glsl; trilobe\.convert\(model, path\) writes that"):
        isotropic().save(path)
    assert not path.exists()
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(trilobe.Error, match=r"trilobe\.read reads measurements"):
        trilobe.load(path)


def test_a_model_that_makes_light_is_saved_with_a_warning(tmp_path):
    bright = lambertian().replace(d=[0.5, 0.2, 0.1])  # pi times that is reflected
    with pytest.warns(UserWarning, match=r"reflects 1\.57 times the light"):
        bright.save(tmp_path / "bright.json")
    assert trilobe.load(tmp_path / "bright.json") == bright
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lambertian().save(tmp_path / "right.json")


def test_tables_know_their_axes():
    brdf = anisotropic()
    assert brdf.D.dims == ("lobe", "theta_h", "phi_h")
    assert brdf.F.dims == ("channel", "theta_d")
    np.testing.assert_allclose(np.degrees(brdf.G.coords["theta"]), [0, 20, 50, 80])
    np.testing.assert_allclose(np.degrees(isotropic().G.coords["theta"][:2]), [0.5, 1.5])
    assert (brdf.D * 2).dims == brdf.D.dims
    assert brdf.D[0].dims == ()
    with pytest.raises(ValueError, match="read-only"):
        brdf.D[0] = 1
    assert pickle.loads(pickle.dumps(brdf.D)).dims == brdf.D.dims


def test_is_edited_by_replacing():
    brdf = isotropic()
    wi, wo = directions(50, 15), directions(50, 16)
    twice = brdf.replace(D=brdf.D * 2, d=np.asarray(brdf.d) * 2)
    np.testing.assert_allclose(twice.eval(wi, wo), 2 * brdf.eval(wi, wo), rtol=1e-9)
    back = trilobe.Brdf(brdf.d, brdf.s, brdf.D, brdf.F, brdf.G)
    assert back == brdf
    fewer = trilobe.Brdf(brdf.d, brdf.s[:1], brdf.D[:1], brdf.F, brdf.G[:1])
    np.testing.assert_allclose(fewer.eval(wi, wo, components=True)[:, 1],
                               brdf.eval(wi, wo, components=True)[:, 1])


BAD = [
    (lambda b: b.eval([0, 1], [0, 0, 1]), r"wi has the shape \(2,\); directions are an array of the"),
    (lambda b: b.eval(1, [0, 0, 1]), r"wi has the shape \(\)"),
    (lambda b: b.eval(np.ones((2, 3)), np.ones((3, 3))), "do not go together"),
    (lambda b: b.eval("up", [0, 0, 1]), "wi has the dtype <U2"),
    (lambda b: b.eval([0, 0, 1j], [0, 0, 1]), "wi has the dtype complex128"),
    (lambda b: b.eval(None, [0, 0, 1]), "wi has the dtype object"),
    (lambda b: b.eval([[0, 0, 1], [0]], [0, 0, 1]), "wi cannot be read as an array"),
    (lambda b: b.sample([0, 0, 1], [0.5]), r"u has the shape \(1,\)"),
    (lambda b: b.replace(D=b.D[:, :9]), r"D has the shape \(3, 9\), and must have \(3, 90\)"),
    (lambda b: b.replace(D=-np.asarray(b.D)), r"D\[0, 0\] is -[0-9.e-]+; all entries"),
    (lambda b: b.replace(s=np.asarray(b.s) * np.nan), r"s\[0, 0\] is nan"),
    (lambda b: b.replace(s=[1, 2, 3]), r"s has the shape \(3,\), and must have \(lobes, 3\)"),
    (lambda b: b.replace(d=np.full(3, np.inf)), r"d\[0\] is inf"),
    (lambda b: b.replace(stretch=(1, 2, 3)), "stretch has the shape"),
    (lambda b: b.replace(stretch=(1, 20)), "stretch"),
    (lambda b: b.unobserved("H"), "there is no factor 'H'"),
    (lambda b: b.save("/no/such/folder/x.json"), "cannot write '/no/such/folder/x.json'"),
    (lambda b: b.save("."), "cannot write '.': it is a folder"),
    (lambda b: b.save(7), "a path must be a str"),
    (lambda b: trilobe.load("/no/such/model.json"), "cannot read '/no/such/model.json': No such file"),
    (lambda b: trilobe.load(b"\0"), "is no path"),
    (lambda b: trilobe.load(None), "a path must be"),
    (lambda b: trilobe.Brdf.from_json("{}", "x.json"), "x.json"),
    (lambda b: trilobe.Brdf.from_json("\ud800"), "the text"),
    (lambda b: trilobe.Brdf.from_json(b.to_json()[:99]), "the text"),
    (lambda b: trilobe.Brdf(0, [[1, 1, 1]] * 9, *([np.ones((9, 90))] * 3)), r"must have \(3, 90\)"),
    (lambda b: trilobe.Brdf(0, [[1, 1, 1]] * 9, np.ones((9, 90)), np.ones((3, 90)),
                            np.ones((9, 90))), "lobes"),
    (lambda b: trilobe.Brdf(0, [[1, 1, 1]], [[1, 1]], np.ones((3, 90)), np.ones((1, 90))), "D"),
]


@pytest.mark.parametrize(("ask", "told"), BAD)
def test_says_in_a_line_what_is_wrong(ask, told):
    with pytest.raises(trilobe.Error, match=told) as caught:
        ask(isotropic())
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_errors_have_a_kind_and_facts():
    with pytest.raises(trilobe.Error) as caught:
        trilobe.load("/no/such/model.json")
    error = caught.value
    assert (error.kind, error.file, error.line) == ("file", "/no/such/model.json", None)
    assert (error.key, error.value) == ("read", "No such file or directory")
    with pytest.raises(trilobe.Error) as caught:
        trilobe.Brdf.from_json("{}", "x.json")
    assert (caught.value.kind, caught.value.file, caught.value.key) == ("missing", "x.json", "format")
    with pytest.raises(trilobe.Error) as caught:
        isotropic().eval([0, 0, 1], [0, 0, 0, 1])
    assert (caught.value.kind, caught.value.key) == ("mismatch", "wo")


@pytest.mark.parametrize(("flags", "keywords"), [
    ("--model=auto has starts; leave out --nodes, --d_nodes and --raw.",
     'model="auto" has starts; leave out nodes=, d_nodes= and raw=True.'),
    ("--tilt=a lot: give a number", 'tilt="a lot": give a number'),
    ("x.csv: give --columns=theta_i,f or '--columns=phi_o=a b', --scale=0.3183.",
     'x.csv: give columns="theta_i,f" or columns="phi_o=a b", scale=0.3183.'),
    ("--theta_i=DEGREES gives it; --nodiagnose saves time (--data_seed)",
     "theta_i=DEGREES gives it; diagnose=False saves time (seed=)"),
    ("--next needs more; begin with trilobe measure --directions=20",
     "next= needs more; begin with trilobe.directions_to_measure(20)"),
    ("cannot read '/a/--lobes/b--c.csv': --- is no number", "cannot read '/a/--lobes/b--c.csv': --- is no number"),
])
def test_messages_of_the_program_name_keywords(flags, keywords):
    assert in_keywords(flags) == keywords


def test_many_threads_may_use_one_model():
    brdf = anisotropic()
    wi, wo = directions(2000, 17), directions(2000, 18)
    results = [None] * 8

    def work(k):
        results[k] = brdf.eval(wi, wo), brdf.sample(wi, np.full(2, 0.3)).weight

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for f, weight in results:
        np.testing.assert_array_equal(f, results[0][0])
        np.testing.assert_array_equal(weight, results[0][1])


def test_tables_are_arrays_of_xarray():
    xarray = pytest.importorskip("xarray")
    brdf = trilobe.load("material:acrylic_felt_pink")
    for table in (brdf.s, brdf.D, brdf.F, brdf.G):
        array = xarray.DataArray(table, dims=table.dims, coords=table.coords)
        assert array.equals(table.to_xarray())
        assert list(array.coords.get("channel", ["red", "green", "blue"])) == ["red", "green", "blue"]


def test_modules_are_loaded_when_they_are_used():
    code = "import trilobe; assert trilobe.plot.factors; assert not hasattr(trilobe, 'plots')"
    pytest.importorskip("matplotlib")
    subprocess.run([sys.executable, "-c", code], check=True)
