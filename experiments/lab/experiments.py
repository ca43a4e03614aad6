"""The experiments: folders with a manifest.json, an experiment.py and a README.md.

experiment.py has three functions. Only the first and the second see the program's results, so
pictures can be drawn again anywhere from the tables alone.

    units(setting) -> [Unit]             what to run; labels say what each is
    tabulate(setting, results) -> {name: rows or bytes}
                                         rows, a list of dicts, become NAME.csv; bytes the file NAME
    draw(tables, folder) -> {name: Figure or text}
                                         tables: {name: rows} as read back; folder: of all files
                                         of tabulate; a Figure becomes NAME.png, a text NAME
"""
import dataclasses
import importlib.util
import json
import pathlib

from lab import UsageError, manifest, materials

FOLDER = pathlib.Path(__file__).resolve().parents[1]


@dataclasses.dataclass(frozen=True)
class Setting:
    """Settings of one run."""

    name: str
    form: str  # "full", or one of manifest.FORMS
    manifest: dict  # that of the form that runs, with the changes asked for
    sources: list  # [Source], those given or else the manifest's, before any choice among them
    build: pathlib.Path
    main_program: pathlib.Path

    @property
    def quick(self):
        return self.form == "quick"

    def program(self, name="trilobe"):
        """The program `trilobe`, or one that experiments/CMakeLists.txt builds."""
        path, how = self.main_program, "./run builds it in build/release"
        if name != "trilobe":
            path = self.build / "experiments" / name
            how = ("./check builds it and installs what that takes; with the packages of the group check in "
                   f"dependencies.txt so does: cmake -S {FOLDER.parent} -B {self.build} "
                   f"-DTRILOBE_BUILD_EXPERIMENTS=ON && cmake --build {self.build} --target {name}")
        if not path.is_file():
            raise UsageError(f"no program {path}; {how}")
        return path

    def reading(self, source):
        """Flags of all commands that read this source: what the manifest's "reading" has for its
        database, {"RGL": {"max_angle": 75}}."""
        return self.manifest.get("reading", {}).get(source.database, {})

    def place(self, name):
        """The file or folder that a member of the manifest names, None where it names none.

        It may lie anywhere: the absolute path makes units count a file by its bytes alone.
        """
        given = self.manifest[name]
        if given is None:
            return None
        path = pathlib.Path(given).resolve()
        if not path.exists():
            raise UsageError(f"{name}: {given} does not exist")
        return path

    def every(self, n):
        """Every n-th source of each list of materials."""
        return materials.every(self.sources, n)


@dataclasses.dataclass(frozen=True)
class Result:
    """A unit and the folder that it has filled, None if it is missing."""

    unit: object
    folder: pathlib.Path | None

    @property
    def labels(self):
        return self.unit.labels


@dataclasses.dataclass(frozen=True)
class Experiment:
    name: str
    module: object

    @property
    def folder(self):
        return FOLDER / self.name

    @property
    def page(self):
        return self.folder / "README.md"

    def published(self, form="full"):
        """The folder of the run's tables and pictures that the page quotes."""
        return self.folder / ("results" if form == "full" else f"results_{form}")

    @property
    def title(self):
        return self.page.read_text().splitlines()[0].removeprefix("# ")

    def forms(self):
        """The forms for measurements: the full one, and that of anisotropic materials where there is one."""
        given = json.loads((self.folder / "manifest.json").read_text())
        return ["full", *(form for form in ("anisotropic",) if form in given)]

    def settings(self, form="full", changes=()):
        return settings(self.name, form, changes)


def settings(name, form="full", changes=()):
    """The experiment's manifest, without loading its code."""
    return manifest.load(FOLDER / name / "manifest.json", form, changes)


def names():
    return sorted(path.parent.name for path in FOLDER.glob("*/manifest.json"))


def load(name):
    """Raises UsageError that lists the known names."""
    if name not in names():
        raise UsageError(f"unknown experiment '{name}'; known: {', '.join(names())}")
    path = FOLDER / name / "experiment.py"
    spec = importlib.util.spec_from_file_location(f"experiment_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return Experiment(name, module)
