"""`fit_texels`: what a surface is made of is found, in memory and in a folder, whatever ends it in between."""

import functools
import multiprocessing
import os
import struct
import subprocess
import sys

import numpy as np
import pytest

import trilobe
from trilobe._texels import source

from models import directions, isotropic

pytest.importorskip("trilobe._fit", reason="only what evaluates is built")

QUIET = {"progress": False}
THREE_ROWS = 3 * 24 * 64 * 3
SOON = {"lobes": 1, "max_seconds": 0.1}


@pytest.fixture(scope="module")
def pair():
    """wi and wo of 64 samples, half of them near highlights."""
    wi, wo = directions(64, 1), directions(64, 2)
    wo[::2] = wi[::2] * [-1, -1, 1] + 0.2 * wo[::2]
    return wi, wo


@functools.lru_cache
def materials():
    """Models of one lobe each, from sharp to broad, in three colours."""
    brdf = isotropic()
    theta = (np.arange(90) + 0.5) / 90
    made = []
    for width, colour in ((0.2, [2, 0.5, 0.3]), (0.35, [0.3, 1, 0.4]), (0.6, [0.2, 0.3, 0.6])):
        D = np.exp(-((theta / width) ** 2))[None]
        made.append(trilobe.Brdf(0.05, [colour], D, brdf.F, brdf.G[:1]))
    return made


def values(d, s, of, pair):
    """The formula, for d (..., 3) and s [materials] of (..., 3)."""
    lobes = [brdf.eval(*pair, components=True)[:, 1] for brdf in of]
    return d[..., None, :] + sum(weight[..., None, :] * f for weight, f in zip(s, lobes))


def surface(pair, shape=(20, 24), coloured=False):
    rng = np.random.default_rng(5)
    d = 0.3 * rng.random((*shape, 3))
    s = rng.random((3, *shape, 3 if coloured else 1)) * (rng.random((3, *shape, 1)) < 0.7) * np.ones(3)
    return d, s, values(d, s, materials(), pair)


def assert_is(texels, d, s):
    np.testing.assert_allclose(texels.d, d, atol=1e-5)
    np.testing.assert_allclose(np.array(texels.s), s, atol=1e-5)
    assert texels.error.max() < 1e-6


@pytest.mark.parametrize("coloured", [False, True])
def test_finds_what_texels_are_made_of(pair, coloured):
    d, s, rho = surface(pair, coloured=coloured)
    texels = trilobe.fit_texels(pair, rho, materials(), coloured=coloured, **QUIET)
    assert texels.shape == (20, 24) and "20 x 24, 3 materials" in repr(texels)
    assert_is(texels, d, s)
    row = trilobe.fit_texels(pair, rho.reshape(-1, 64, 3), materials(), coloured=coloured, threads=1, **QUIET)
    assert row.shape == (480,) and row.d.shape == (480, 3)
    assert np.array_equal(row.d.reshape(20, 24, 3), texels.d)


def test_is_the_least_error(pair):
    from scipy.optimize import nnls

    d, s, rho = surface(pair, (40,))
    rho *= np.random.default_rng(6).lognormal(0, 0.3, rho.shape)
    texels = trilobe.fit_texels(pair, rho, materials(), weighting="uniform", **QUIET)
    lobes = np.stack([brdf.eval(*pair, components=True)[:, 1] for brdf in materials()])
    columns = np.concatenate([np.tile(np.eye(3), (64, 1)), lobes.reshape(3, -1).T], axis=1)
    for k in range(40):
        x, residual = nnls(columns, rho[k].ravel())
        np.testing.assert_allclose(texels.d[k], x[:3], atol=1e-5)
        np.testing.assert_allclose([strength[k, 0] for strength in texels.s], x[3:], atol=1e-5)
        np.testing.assert_allclose(texels.error[k], residual / np.linalg.norm(rho[k]), rtol=1e-5)


def test_evaluates(pair):
    d, s, rho = surface(pair)
    texels = trilobe.fit_texels(pair, rho, materials(), **QUIET)
    wi, wo = directions(2, 7)
    wanted = values(d, s, materials(), (wi[None], wo[None]))[..., 0, :]
    np.testing.assert_allclose(texels.eval(wi, wo), wanted, rtol=1e-4, atol=1e-6)
    each = directions(480, 8).reshape(20, 24, 3)
    one = texels.eval(each[3, 4], wo)[3, 4]
    np.testing.assert_allclose(texels.eval(each, wo)[3, 4], one)
    assert not texels.eval([0, 0, -1], wo).any()
    assert texels.eval(np.float32([0, 0, 1]), np.float32([0, 0, 1])).dtype == np.float32
    with pytest.raises(trilobe.Error, match=r"must have \(3,\) or \(20, 24, 3\)"):
        texels.eval(each[:3], wo)


def test_leaves_out_samples_of_a_texel(pair):
    d, s, rho = surface(pair)
    rho[3, 4, :9] = np.nan
    rho[5, 6, 7, 1] = -1e-9
    rho[7, 8, 3] = np.inf
    rho[9, 9] = -1
    texels = trilobe.fit_texels(pair, rho, materials(), **QUIET)
    assert not texels.d[9, 9].any() and texels.error[9, 9] == 0
    d[9, 9] = s[:, 9, 9] = 0
    assert_is(texels, d, s)


def test_a_material_may_be_found(pair):
    rng = np.random.default_rng(3)
    of = materials()[0], materials()[2]
    part = rng.random((30, 30, 1)) < 0.5
    strength = (0.5 + rng.random((30, 30, 1))) * np.ones(3)
    s = np.stack([strength * part, strength * ~part])
    rho = values(0.1 * rng.random((30, 30, 3)), s, of, pair)
    rho *= 1 + 0.01 * rng.normal(size=rho.shape)
    texels = trilobe.fit_texels(pair, rho, 2, lobes=1, raw=True, max_iterations=20, **QUIET)
    assert np.median(texels.error) < 0.03
    found = np.array(texels.s)[..., 0].reshape(2, -1)
    alike = np.abs(np.corrcoef(found, s[..., 0].reshape(2, -1))[:2, 2:])
    assert (alike.max(axis=1) > 0.99).all() and sorted(alike.argmax(axis=1)) == [0, 1]


# Folders.


class Slices:
    """Array with the slices of h5py and zarr; counts the rows read, and stops after some tiles."""

    def __init__(self, array, most=10**9):
        self.shape, self.array, self.most, self.rows = array.shape, array, most, 0

    def __getitem__(self, rows):
        self.rows += rows.stop - rows.start
        self.most -= rows.stop - rows.start > 1
        if self.most < 0:
            raise KeyboardInterrupt
        return self.array[rows]


@pytest.fixture
def tiles(monkeypatch):
    """Tiles of three rows."""
    monkeypatch.setattr(source, "_TILE", THREE_ROWS)


def test_a_folder_goes_on(pair, tiles, tmp_path):
    d, s, rho = surface(pair)
    whole = trilobe.fit_texels(pair, rho, materials(), **QUIET)
    with pytest.raises(KeyboardInterrupt):
        trilobe.fit_texels(pair, Slices(rho, 4), materials(), out=tmp_path / "out", **QUIET)
    assert len(list((tmp_path / "out" / "tiles").iterdir())) == 4
    with pytest.raises(trilobe.Error, match="cannot read"):
        trilobe.load_texels(tmp_path / "out")
    rest = Slices(rho)
    texels = trilobe.fit_texels(pair, rest, materials(), out=tmp_path / "out", threads=1, **QUIET)
    assert rest.rows == 20 + (20 - 4 * 3)  # a look at all of them, and what was not done
    for again in (texels, trilobe.load_texels(tmp_path / "out")):
        assert np.array_equal(again.d, whole.d) and np.array_equal(again.error, whole.error)
        assert all(np.array_equal(*two) for two in zip(again.s, whole.s))
        assert again.materials == whole.materials
    names = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert names == {"d.exr", "error.exr", "s0.exr", "s1.exr", "s2.exr", "texels.json", "materials/0.json",
                     "materials/1.json", "materials/2.json"}
    done = Slices(rho)
    trilobe.fit_texels(pair, done, materials(), out=tmp_path / "out", **QUIET)
    assert done.rows == 20
    for other in ({"rho": rho * 2}, {"coloured": True}, {"weighting": "log"}, {"shared": materials()[:2]}):
        arguments = {"rho": rho, "shared": materials(), **other}
        with pytest.raises(trilobe.Error, match="other values or options"):
            trilobe.fit_texels(pair, out=tmp_path / "out", **arguments, **QUIET)


def run_shard(pair, rho, k, out):
    source._TILE = THREE_ROWS
    assert trilobe.fit_texels(pair, rho, 1, out=out, shard=(k, 3), **SOON, **QUIET) is None


def test_shards_agree(pair, tiles, tmp_path):
    _, _, rho = surface(pair)
    np.save(tmp_path / "rho.npy", rho)
    path = str(tmp_path / "rho.npy")
    context = multiprocessing.get_context("spawn")
    at_once = [context.Process(target=run_shard, args=(pair, path, k, tmp_path / "out")) for k in (1, 2)]
    for process in at_once:
        process.start()
    for process in at_once:
        process.join()
        assert process.exitcode == 0
    run_shard(pair, path, 3, tmp_path / "out")
    texels = trilobe.fit_texels(pair, path, 1, out=tmp_path / "out", **SOON, **QUIET)
    whole = trilobe.fit_texels(pair, rho, texels.materials, **QUIET)
    assert np.array_equal(texels.d, whole.d) and np.array_equal(texels.s[0], whole.s[0])
    assert not [path for path in (tmp_path / "out").iterdir() if path.name.startswith(".")]


@pytest.mark.parametrize("coloured", [False, True])
@pytest.mark.parametrize("shape", [(20, 24), (50,), (1, 1)])
def test_saves(pair, tmp_path, shape, coloured):
    _, _, rho = surface(pair, shape, coloured)
    texels = trilobe.fit_texels(pair, rho, materials(), coloured=coloured, **QUIET)
    texels.save(tmp_path / "a" / "b")
    again = trilobe.load_texels(tmp_path / "a" / "b")
    assert again.shape == shape and np.array_equal(again.d, texels.d)
    assert all(np.array_equal(*two) for two in zip(again.s, texels.s))
    wi, wo = directions(2, 7)
    assert np.array_equal(again.eval(wi, wo), texels.eval(wi, wo))


def lines_of(path):
    """An OpenEXR file's lines, by the letter of its specification: {channel: (height, width)}."""
    data = path.read_bytes()
    assert data[:8] == struct.pack("<2i", 20000630, 2)
    at, attributes = 8, {}

    def text():
        nonlocal at
        end = data.index(b"\0", at)
        found, at = data[at:end].decode(), end + 1
        return found

    while data[at]:
        name, _ = text(), text()
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name], at = data[at + 4 : at + 4 + size], at + 4 + size
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = [entry[:1].decode() for entry in attributes["channels"].split(b"\0" * 1) if entry[:1] in (b"R", b"G", b"B")]
    names = names or ["Y"]
    assert attributes["compression"] == b"\0" and attributes["channels"][2:6] == struct.pack("<i", 2)
    offsets = struct.unpack_from(f"<{height}Q", data, at + 1)
    rows = []
    for y, offset in enumerate(offsets):
        assert struct.unpack_from("<2i", data, offset) == (y, 4 * width * len(names))
        rows.append(np.frombuffer(data, "<f4", width * len(names), offset + 8).reshape(len(names), width))
    assert offsets[-1] + 8 + 4 * width * len(names) == len(data)
    return {name: np.array([row[k] for row in rows]) for k, name in enumerate(names)}


def test_pictures_are_open_exr(pair, tmp_path):
    _, _, rho = surface(pair)
    texels = trilobe.fit_texels(pair, rho, materials(), **QUIET)
    texels.save(tmp_path)
    picture = lines_of(tmp_path / "d.exr")
    assert list(picture) == ["B", "G", "R"]
    assert np.array_equal(np.stack([picture[name] for name in "RGB"], axis=-1), texels.d)
    assert np.array_equal(lines_of(tmp_path / "s1.exr")["Y"], texels.s[1][..., 0])


MEASURE = """
import resource, sys
import numpy as np
import trilobe
from models import isotropic

class Endless:
    def __init__(self, rows):
        self.shape = rows, 250, 64, 3
    def __getitem__(self, rows):
        return np.full((rows.stop - rows.start, *self.shape[1:]), 0.5, np.float32)

def peak(rows):
    pair = np.tile([0.6, 0, 0.8], (64, 1)), np.tile([0, 0.6, 0.8], (64, 1))
    trilobe.fit_texels(pair, Endless(rows), isotropic(), out=f"{sys.argv[1]}/{rows}", progress=False)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

print(peak(100), peak(600))
"""


def test_memory_does_not_grow_with_texels(tmp_path):
    here = os.path.dirname(__file__)
    command = [sys.executable, "-c", MEASURE, str(tmp_path)]
    path = os.pathsep.join([here, os.environ.get("PYTHONPATH", "")])
    told = subprocess.run(command, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=True)
    few, many = (int(kib) for kib in told.stdout.split())
    assert many - few < 30_000  # float32 values take 112,500, float64 ones 225,000


# Invalid arguments.


@pytest.mark.parametrize("change, told", [
    ({"directions": 3}, "must be (wi, wo)"),
    ({"directions": (np.ones((63, 3)), np.ones((64, 3)))}, "a row for each sample"),
    ({"directions": (np.ones((64, 3)), -np.ones((64, 3)))}, "wo[0] is no direction above"),
    ({"directions": (np.full((64, 3), np.nan), np.ones((64, 3)))}, "wi[0] is no direction above"),
    ({"directions": (np.zeros((64, 3)), np.ones((64, 3)))}, "wi[0] is no direction above"),
    ({"rho": np.ones((4, 64))}, "must have (height, width, samples, 3)"),
    ({"rho": np.ones((4, 64, 4))}, "must have (height, width, samples, 3)"),
    ({"rho": np.full((4, 64, 3), "x")}, "must be of real numbers"),
    ({"rho": "nowhere.npy"}, "cannot map 'nowhere.npy'"),
    ({"rho": 1.5}, "must have (height, width, samples, 3)"),
    ({"shared": []}, "give 1 to 6"),
    ({"shared": 0}, "give 1 to 6"),
    ({"shared": 7}, "give 1 to 6"),
    ({"shared": ["nowhere.json"]}, "cannot read"),
    ({"shared": 1.5}, "shared must be models"),
    ({"shared": [1]}, "must be a trilobe.Brdf"),
    ({"weighting": "heavy"}, "unknown weighting"),
    ({"weighting": 3}, "weighting must be"),
    ({"coloured": "yes"}, "coloured must be"),
    ({"threads": "all"}, "threads must be"),
    ({"threads": -1}, "threads"),
    ({"lobes": 1}, "lobes is for materials that are to be found"),
    ({"shared": 1, "start": 3}, "start cannot be chosen"),
    ({"shared": 1, "rho": np.zeros((0, 64, 3))}, "there is no texel"),
    ({"shared": 1, "rho": np.full((9, 64, 3), np.nan)}, "no sample of the texels is valid"),
    ({"shard": (1, 2)}, "a shard needs a folder"),
    ({"shard": (3, 2), "out": "out"}, "k from 1 to n"),
    ({"shard": 3, "out": "out"}, "k from 1 to n"),
    ({"out": 3}, "a path must be"),
    ({"out": "file"}, "cannot"),
])
def test_says_what_is_wrong(pair, change, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    arguments = {"directions": pair, "rho": np.ones((4, 64, 3)), "shared": materials(), **QUIET, **change}
    with pytest.raises(trilobe.Error) as error:
        trilobe.fit_texels(**arguments)
    assert told in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["d.exr", "s1.exr", "materials/1.json"])
def test_files_of_others_stay(pair, tmp_path, name):
    _, _, rho = surface(pair)
    texels = trilobe.fit_texels(pair, rho, materials(), **QUIET)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("mine")
    with pytest.raises(trilobe.Error, match=f"{name}' exists, and Trilobe has not written it"):
        texels.save(tmp_path)
    with pytest.raises(trilobe.Error, match=f"{name}' exists, and Trilobe has not written it"):
        trilobe.fit_texels(pair, rho, materials(), out=tmp_path, **QUIET)
    assert (tmp_path / name).read_text() == "mine"
    texels.save(tmp_path, force=True)
    texels.save(tmp_path)
    assert np.array_equal(trilobe.load_texels(tmp_path).d, texels.d)


@pytest.mark.parametrize("shape", [(0, 7), (7, 0), (0,)])
def test_no_texel_is_none(pair, tmp_path, shape):
    texels = trilobe.fit_texels(pair, np.empty((*shape, 64, 3)), materials(), **QUIET)
    assert texels.shape == shape and texels.s[0].shape == (*shape, 3)
    assert texels.eval([0, 0, 1], [0, 0, 1]).shape == (*shape, 3)
    with pytest.raises(trilobe.Error, match="there is no texel"):
        texels.save(tmp_path)


def test_any_order_in_memory(pair):
    d, s, rho = surface(pair)
    odd = np.asfortranarray(np.repeat(rho, 2, axis=1))[:, ::2].astype(">f4")
    texels = trilobe.fit_texels(pair, odd, materials(), **QUIET)
    np.testing.assert_allclose(texels.d, d, atol=1e-4)


def test_a_broken_folder_is_told(pair, tmp_path):
    with pytest.raises(trilobe.Error, match="no texels.json"):
        trilobe.load_texels(tmp_path)
    texels = trilobe.fit_texels(pair, np.ones((4, 64, 3)), materials(), **QUIET)
    texels.save(tmp_path)
    good = (tmp_path / "s1.exr").read_bytes()
    for bad in (good[:-1], good[:9], b"", good.replace(b"compression", b"compromises", 1)):
        (tmp_path / "s1.exr").write_bytes(bad)
        with pytest.raises(trilobe.Error, match="is no picture of 1 x 4"):
            trilobe.load_texels(tmp_path)
    for bad in ("", "[]", "{}", '{"format": "trilobe-texels", "version": 1, "shape": [-1], "materials": 1}', "\0"):
        (tmp_path / "texels.json").write_text(bad)
        with pytest.raises(trilobe.Error, match="is none of trilobe.fit_texels"):
            trilobe.load_texels(tmp_path)
