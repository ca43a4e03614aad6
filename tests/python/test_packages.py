"""Packages that pip installs: trilobe, and trilobe-evaluate, on which it depends."""

from pathlib import Path

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


def test_the_package_has_the_modules_of_its_sources_and_no_others():
    built, sources = Path(trilobe.__file__).parent, ROOT / "python/trilobe"
    assert modules_in(built) == modules_in(sources)
    assert (built / "py.typed").exists()


def modules_in(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.py"))
