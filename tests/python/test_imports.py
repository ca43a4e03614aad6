"""Modules of the package import each other without a circle, and so do its folders."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "python" / "trilobe"
EXTENSIONS = {"trilobe._core", "trilobe._fit"}


def imports_of(package):
    """For each module the others that it imports: at once, in functions or for types, and the folders around it.

    The package itself, which imports all for its users, is around nothing here; but who takes a name from it is told.
    """
    trees = {}
    for path in package.rglob("*.py"):
        parts = path.relative_to(package.parent).with_suffix("").parts
        trees[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = ast.parse(path.read_text())
    modules = {*trees, *EXTENSIONS}
    imports = {}
    for module, tree in trees.items():
        named = [name for node in ast.walk(tree) for name in names_in(node)]
        found = {next(around for around in (name, *folders_around(name), "trilobe") if around in modules)
                 for name in named if name.split(".")[0] == "trilobe"}
        imports[module] = (found | {*folders_around(module)}) - {module}
    return imports


def names_in(node):
    """Dotted names that a statement imports, of modules or of what is in them."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0, "imports are absolute"
        return [f"{node.module}.{alias.name}" for alias in node.names]
    return []


def folders_around(name):
    """Dotted names of what a name stands in, the nearest first, without the package itself."""
    parts = name.split(".")
    return [".".join(parts[:count]) for count in range(len(parts) - 1, 1, -1)]


def by_folder(imports):
    """The same of folders; a module directly in the package stands for itself."""
    folders = {}
    for module, found in imports.items():
        folder = folder_of(module)
        folders.setdefault(folder, set()).update({folder_of(other) for other in found} - {folder})
    return folders


def folder_of(module):
    return ".".join(module.split(".")[:2])


def check(imports):
    """Raises CycleError, with the circle, if there is one."""
    TopologicalSorter(imports).prepare()


def test_modules_import_each_other_without_a_circle():
    check(imports_of(PACKAGE))


def test_folders_import_each_other_without_a_circle():
    check(by_folder(imports_of(PACKAGE)))


def test_private_modules_stand_in_folders():
    assert [path.name for path in PACKAGE.glob("_*.py")] == ["__init__.py"]


def made_up(folder, modules):
    package = folder / "trilobe"
    for name, text in {"__init__": "from trilobe._a.one import f", "_a/__init__": "", "_b/__init__": "",
                       **modules}.items():
        path = package / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return imports_of(package)


@pytest.mark.parametrize("text", [
    "from trilobe._a.one import f",
    "def g():\n    from trilobe._a import one",
    "if TYPE_CHECKING:\n    import trilobe._a.one",
    "from trilobe import f",
])
def test_finds_a_circle_of_modules(tmp_path, text):
    one = {"_a/one": "from trilobe._core import Error\nfrom trilobe._a.two import g"}
    check(made_up(tmp_path, {**one, "_a/two": "import numpy"}))
    with pytest.raises(CycleError):
        check(made_up(tmp_path, {**one, "_a/two": text}))


def test_finds_a_folder_that_imports_what_is_in_it(tmp_path):
    with pytest.raises(CycleError):
        check(made_up(tmp_path, {"_a/__init__": "from trilobe._a.one import f", "_a/one": ""}))


def test_finds_a_circle_of_folders(tmp_path):
    imports = made_up(tmp_path, {"_a/one": "import trilobe._b.one", "_b/one": "", "_b/two": "import trilobe._a.two",
                                 "_a/two": ""})
    check(imports)
    with pytest.raises(CycleError):
        check(by_folder(imports))
