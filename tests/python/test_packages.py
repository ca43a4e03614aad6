"""Packages that pip installs: trilobe, and trilobe-evaluate, on which it depends."""

import importlib.util
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import trilobe

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    "name, text",
    [
        ("CMakeLists.txt", "project(trilobe VERSION {} "),
        ("pyproject.toml", '\nversion = "{}"\n'),
        ("pyproject.toml", '\ndependencies = ["trilobe-evaluate=={}"]\n'),
        ("python/evaluate/pyproject.toml", '\nversion = "{}"\n'),
    ],
)
def test_both_packages_and_the_program_are_of_one_version(name, text):
    assert text.format(trilobe.__version__) in (ROOT / name).read_text()


@pytest.fixture
def backend(monkeypatch, tmp_path):
    """What builds the package, in a checkout of that alone, with scikit-build-core played by a function."""

    def prepare(folder, settings):
        (Path(folder) / "trilobe.dist-info").mkdir()
        (Path(folder) / "trilobe.dist-info/METADATA").write_text(
            "Requires-Dist: trilobe-evaluate==0.2.0\nRequires-Dist: trilobe-evaluate[plot]; extra == 'plot'\n"
        )
        return "trilobe.dist-info"

    hooks = SimpleNamespace(prepare_metadata_for_build_wheel=prepare, prepare_metadata_for_build_editable=prepare)
    monkeypatch.setitem(sys.modules, "scikit_build_core", SimpleNamespace(build=hooks))
    monkeypatch.setitem(sys.modules, "scikit_build_core.build", hooks)
    path = tmp_path / "a checkout/python/packaging/trilobe_backend.py"
    path.parent.mkdir(parents=True)
    path.write_text((ROOT / "python/packaging/trilobe_backend.py").read_text())
    spec = importlib.util.spec_from_file_location("trilobe_backend", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("kind", ["wheel", "editable"])
def test_pip_is_told_where_a_checkout_has_the_other_package(backend, tmp_path, kind):
    name = getattr(backend, f"prepare_metadata_for_build_{kind}")(tmp_path)
    checkout = (tmp_path / "a checkout").as_uri()
    assert (tmp_path / name / "METADATA").read_text() == (
        f"Requires-Dist: trilobe-evaluate @ {checkout}/python/evaluate\n"
        "Requires-Dist: trilobe-evaluate[plot]; extra == 'plot'\n"
    )


def test_a_source_distribution_names_the_version(backend, tmp_path):
    (tmp_path / "a checkout/PKG-INFO").touch()
    name = backend.prepare_metadata_for_build_wheel(tmp_path)
    assert "Requires-Dist: trilobe-evaluate==0.2.0\n" in (tmp_path / name / "METADATA").read_text()


def test_the_package_has_the_modules_of_its_sources_and_no_others():
    built, sources = Path(trilobe.__file__).parent, ROOT / "python/trilobe"
    assert modules_in(built) == modules_in(sources)
    assert (built / "py.typed").exists()


def modules_in(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.py"))
