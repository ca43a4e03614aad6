"""`trilobe-need scene.xml --out=need/`: what a scene of Mitsuba needs of its materials (docs/need.md).

Materials are the BSDFs `trilobe` and `trilobe_measured` of the scene. It is rendered by a path tracer that counts which
directions of each are read, and for how much of the picture; `trilobe fit --scene` then fits each material as well as
these need it, and leaves out the rest, within budgets that are tried from the largest on, until the picture is right.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.batch import find_program
from trilobe._fitting.fit import fit
from trilobe._fitting.measurement import Measurement, is_model, read
from trilobe._model.brdf import Brdf, load
from trilobe._model.error import Error
from trilobe._model.files import write_text
from trilobe._need.page import left_text
from trilobe._need.plan import Tell, plan_of
from trilobe._need.result import Picture, Result

_MERL = (90, 90, 180)
_COVERAGE = 0.999  # share of reads to cover; the directions of the rest are not used
_KINDS = ("trilobe", "trilobe_measured")


class Options(NamedTuple):
    """Options of a run; `main` has the defaults."""

    spp: int
    count_spp: int
    depth: int
    flip: float
    budgets: list[float]
    parameters: dict[str, str]
    moved: dict[str, str]
    program: str | None
    flags: list[str]


class Material:
    """A material of the scene: where its BSDFs are, and what is known of it."""

    def __init__(self, name: str, source: str) -> None:
        """`source` is as the program takes it."""
        self.name, self.source = name, source
        self.measurement: Measurement | None = None
        self.full: Brdf
        self.fit_seconds = 0.0

    def prepare(self, folder: Path) -> None:
        """Fits a measurement as a whole; a model is its own fit."""
        if is_model(self.source):
            self.full = load(self.source)
        else:
            self.measurement = read(self.source)
            begin = time.perf_counter()
            self.full = fit(self.measurement, progress=False).model
            self.fit_seconds = time.perf_counter() - begin
        self.full.save(folder / f"{self.name}.json")

    @property
    def anisotropic(self) -> bool:
        """Whether azimuths matter, which no histogram over half-vector angles knows."""
        return self.full.anisotropic or (self.measurement is not None and self.measurement.anisotropic)

    @property
    def grid(self) -> tuple[int, int, int]:
        """The bins that are counted in."""
        return (self.measurement and self.measurement.grid) or _MERL

    @property
    def bytes(self) -> int | None:
        """The size of the measurement's file; None if there is no file."""
        return os.path.getsize(self.source) if os.path.isfile(self.source) else None


class SceneFile:
    """A scene of Mitsuba whose materials can be replaced."""

    def __init__(self, path: Path, parameters: dict[str, str]) -> None:
        """Reads it, with values for what it has as `<default>`."""
        self._path, self._parameters = path, parameters
        self.materials: list[Material] = []
        self._named: list[tuple[str, str, int]] = []
        nodes = self._parsed().nodes
        parents: dict[int, list[int]] = {}
        for k, node in enumerate(nodes):
            for child in _children(node):
                parents.setdefault(child, []).append(k)
        for k, node in enumerate(nodes):
            if node.props.plugin_name() not in _KINDS:
                continue
            outer = k
            for parent in parents.get(k, []):
                kind = nodes[parent].props.plugin_name()
                if kind == "twosided":
                    outer = parent
                elif kind != "scene" and "BSDF" in str(nodes[parent].type):
                    raise Error(
                        f"{path}: a material inside a '{kind}' cannot be counted, only in a shape or a twosided")
            source = _source_of(node.props, path.parent)
            name = self._name(nodes, outer, k, source, parents)
            self._named.append((name, source, k))
            if all(name != material.name for material in self.materials):
                self.materials.append(Material(name, source))
        if not self.materials:
            raise Error(f"{path}: there is no BSDF of the type trilobe or trilobe_measured in it")

    def _name(self, nodes: Any, outer: int, own: int, source: str, parents: dict[int, list[int]]) -> str:
        given = nodes[own].props.id() or nodes[outer].props.id()
        text = given or Path(source.split(":")[-1]).stem
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_") or "material"
        known = {known: source for known, source, _ in self._named}
        number = 2
        while name in known and known[name] != source or name.lower() == "plan":
            name, number = f"{name}{number}", number + 1
        return name

    def _parsed(self) -> Any:
        from trilobe._mitsuba.renderer import mi

        config = mi.parser.ParserConfig(mi.variant())
        config.merge_equivalent = config.merge_meshes = False
        state = mi.parser.parse_file(config, str(self._path), **self._parameters)
        mi.parser.transform_all(config, state)
        return state

    def load(self, replaced: dict[str, dict[str, str]]) -> Any:
        """The scene, with other BSDFs for some materials: their properties, and `type`."""
        from trilobe._mitsuba.renderer import mi

        state = self._parsed()
        for number, (name, _, k) in enumerate(self._named):
            props = state.nodes[k].props
            for key in list(props.keys()):
                del props[key]
            properties = dict(replaced[name])
            props.set_plugin_name(properties.pop("type"))
            props.set_id(f"trilobe-need {number}")
            for key, value in properties.items():
                props[key] = value
        mi.file_resolver().prepend(str(self._path.resolve().parent))  # meshes lie beside the scene
        made = mi.parser.instantiate(mi.parser.ParserConfig(mi.variant()), state)
        return made[0] if isinstance(made, list) else made

    def sides(self, scene: Any) -> list[tuple[Any, int, int]]:
        """BSDFs of shapes that are our materials, with their numbers in front and behind."""
        from trilobe._mitsuba.renderer import mi

        number = {material.name: k for k, material in enumerate(self.materials)}
        own = {f"trilobe-need {k}": number[name] for k, (name, _, _) in enumerate(self._named)}
        found: dict[int, tuple[Any, int, int]] = {}
        for shape in scene.shapes():
            bsdf = shape.bsdf()
            texts = [bsdf.id()] if bsdf.id() in own else _nested(mi, bsdf)
            numbers = [own.get(text, -1) for text in texts]
            if any(k >= 0 for k in numbers):
                found[id(bsdf)] = (bsdf, numbers[0], numbers[-1] if len(texts) > 1 else -1)
        return list(found.values())


def _nested(mi: Any, bsdf: Any) -> list[str]:
    """The ids of what a twosided has in front and behind."""
    parameters = mi.traverse(bsdf)
    below = [node for node, (parent, _) in parameters.hierarchy.items() if parent is not None]
    ids = [node.id() for node in below if isinstance(node, mi.BSDF)]
    return [ids[0], ids[-1]] if ids else ["", ""]


def _children(node: Any) -> list[int]:
    return [value.index() for _, value in node.props.items() if type(value).__name__ == "ResolvedReference"]


def _source_of(props: Any, folder: Path) -> str:
    if "filename" not in props:
        raise Error("materials that are counted must be files; give the BSDF a filename")
    source = str(props["filename"])
    if source.startswith(("material:", "synth:")):
        return source
    return str((folder / source).resolve())


# Input of the program.


def _directions(material: Material, counts: Any, folder: Path) -> dict[str, Any]:
    """The entry of the scene file, and the file of a histogram."""
    if material.anisotropic:
        sums = np.array([counts.pairs[: k + 1, : k + 1].sum() for k in range(len(counts.pairs))])
        last = int(np.searchsorted(sums, _COVERAGE * sums[-1])) + 1
        return {"theta_i": [0, min(last, 90)], "theta_o": [0, min(last, 90)]}
    smooth = _smoothed(counts.bins)
    order = np.sort(smooth.ravel())[::-1]
    kept = np.searchsorted(np.cumsum(order), _COVERAGE * order.sum())
    smooth[smooth < order[min(int(kept), len(order) - 1)]] = 0
    name = f"{material.name}.histogram"
    (folder / name).write_bytes(np.array(smooth.shape, "<i4").tobytes() + smooth.astype("<f8").tobytes())
    return {"histogram": name}


def _smoothed(bins: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spreads reads to neighbouring bins, as interpolation does; both sides of the plane of incidence are the same."""
    bins = (bins + bins[..., ::-1]) / 2
    for axis, ends in ((0, "edge"), (1, "edge"), (2, "wrap")):
        width = [(1, 1) if k == axis else (0, 0) for k in range(3)]
        wide = np.moveaxis(np.pad(bins, width, mode=ends), axis, 0)  # type: ignore[call-overload]
        bins = np.moveaxis((wide[:-2] + 2 * wide[1:-1] + wide[2:]) / 4, 0, axis)
    return bins


def _write_scene(
    materials: list[Material], counts: list[Any], budget: float, folder: Path
) -> tuple[Path, list[str]]:
    """The scene file, and the names of the materials that it has: those that are read."""
    read_ones = [(material, count) for material, count in zip(materials, counts) if count.bins.sum() > 0]
    entries = [
        {"name": material.name, "source": material.source, "directions": _directions(material, count, folder)}
        for material, count in read_ones
    ]
    text = {"format": "trilobe-scene", "version": 1, "budget": {"mean_delta_e": budget}, "materials": entries}
    path = folder / "scene.json"
    write_text(path, json.dumps(text, indent=1) + "\n")
    return path, [material.name for material, _ in read_ones]


# The whole.


def _render(scene: Any, spp: int) -> Picture:
    from trilobe._mitsuba.renderer import dr, mi

    dr.eval(mi.render(scene, spp=1))  # compiles
    begin = time.perf_counter()
    image = np.array(mi.render(scene, spp=spp, seed=1), np.float64)[..., :3]
    return Picture(image, time.perf_counter() - begin)


def need(path: Path, out: Path, options: Options, tell: Tell = print) -> dict[str, Any]:
    """Does it all, and returns what `need.json` has."""
    for folder in (out, out / "full", out / "pruned"):
        folder.mkdir(parents=True, exist_ok=True)
    file = SceneFile(path, options.parameters)
    moved = SceneFile(path, {**options.parameters, **options.moved}) if options.moved else None
    settings = {"parameters": options.parameters, "moved": options.moved, "spp": options.spp}
    with Result(out, path.name, settings, [_row(material) for material in file.materials]) as result:

        def add(scene: SceneFile, kind: str, prefix: str = "") -> None:
            materials = {material.name: _bsdf(material, kind, out) for material in file.materials}
            result.add(f"{prefix}{kind}", _render(scene.load(materials), options.spp),
                       "" if kind == "measured" else f"{prefix}measured")

        for number, (material, row) in enumerate(zip(file.materials, result.rows), 1):
            result.tell(f"fitting {material.name}, {number} of {len(file.materials)}")
            material.prepare(out / "full")
            row["seconds"]["full"] = material.fit_seconds
            tell(f"{material.name}: {material.source}, fitted in {material.fit_seconds:.1f} s")
        result.tell("rendering")
        add(file, "measured")
        counts = _count(file, out, options, result, tell)
        add(file, "full")
        tell(f"full models: {_apart(result, 'full')}")
        for budget in options.budgets:
            _prune(file.materials, counts, budget, out, options, result, tell)
            add(file, "pruned")
            parameters = sum(row["parameters"]["pruned"] for row in result.rows)
            flip = result.differences["pruned"].flip
            result.tries.append({"mean_delta_e": budget, "parameters": parameters, "flip": flip})
            tell(f"pruned to {parameters} parameters, {_within(budget)}: {_apart(result, 'pruned')}")
            if flip <= options.flip:
                break
        if moved is not None:
            result.tell("rendering otherwise than it was counted")
            for kind in ("measured", "full", "pruned"):
                add(moved, kind, "moved_")
            for kind in ("full", "pruned"):
                tell(f"moved, {kind}: {_apart(result, f'moved_{kind}')}")
        report = result.finish()
    tell(left_text(report["totals"]))
    return report


def _count(file: SceneFile, out: Path, options: Options, result: Result, tell: Tell) -> list[Any]:
    """Counts what each material is read for."""
    from trilobe._need.count import Counter

    result.tell("counting which directions are read")
    scene = file.load({material.name: _bsdf(material, "measured", out) for material in file.materials})
    counter = Counter(scene, file.sides(scene), [material.grid for material in file.materials], options.depth)
    begin = time.perf_counter()
    counts = counter.count(result.pictures["measured"].linear, options.count_spp, seed=2)
    for row, count in zip(result.rows, counts):
        row["share"] = float(count.bins.sum())
    tell(f"counted in {time.perf_counter() - begin:.1f} s")
    return counts


def _prune(
    materials: list[Material], counts: list[Any], budget: float, out: Path, options: Options, result: Result, tell: Tell
) -> None:
    """Has the program prune the materials, and tells meanwhile how far it is."""

    def told(line: str) -> None:
        tell(f"pruning, {_within(budget)}: {line}")
        result.tell(f"pruning, {_within(budget)}: {line}")

    scene, names = _write_scene(materials, counts, budget, out)
    command = [find_program(options.program), "fit", f"--scene={scene}", f"--out={out / 'pruned'}", *options.flags]
    begin = time.perf_counter()
    plan = plan_of(command, out / "pruned", names, told, result.prune_seconds)
    result.prune_seconds = time.perf_counter() - begin
    planned = {entry["name"]: entry for entry in plan["materials"]}
    for row in result.rows:
        entry = planned.get(row["name"])
        if entry is not None:
            row["seconds"]["pruned"] = entry["seconds"]["fit"] + entry["seconds"]["prune"]
            row.update({key: entry[key] for key in ("parameters", "samples", "verdict")})


def _within(budget: float) -> str:
    return f"Delta E at most {budget:g}"


def _apart(result: Result, name: str) -> str:
    apart = result.differences[name]
    return f"FLIP {apart.flip:.4f}, Delta E {apart.delta_e:.3f}"


def _bsdf(material: Material, kind: str, out: Path) -> dict[str, str]:
    """The BSDF of a material; all are drawn by the same model, so that noise is the same."""
    whole = str((out / "full" / f"{material.name}.json").resolve())
    pruned = out / "pruned" / f"{material.name}.json"
    if kind == "measured" and material.measurement is not None:
        return {"type": "trilobe_measured", "filename": material.source, "model": whole}
    if kind == "pruned" and pruned.exists():  # one that is never seen is not fitted
        return {"type": "trilobe", "filename": str(pruned.resolve()), "sampling": whole}
    return {"type": "trilobe", "filename": whole}


def _row(material: Material) -> dict[str, Any]:
    """The entry of a material, before anything is known of what the scene needs."""
    return {
        "name": material.name, "source": os.path.basename(material.source), "share": 0.0,
        "measured_bytes": material.bytes, "parameters": {"full": 0, "pruned": 0},
        "seconds": {"full": 0.0, "pruned": 0.0},
    }


def _parsed_options(arguments: list[str] | None) -> tuple[Path, Path, Options]:
    parser = argparse.ArgumentParser(prog="trilobe-need", description="What a scene of Mitsuba needs of its materials.")
    parser.add_argument("scene", help="an XML scene whose materials are of the type trilobe or trilobe_measured")
    parser.add_argument("--out", required=True, help="folder to write into")
    parser.add_argument("-D", action="append", default=[], metavar="NAME=VALUE", help="a value for a <default>")
    parser.add_argument("--moved", action="append", default=[], metavar="NAME=VALUE",
                        help="values with which the scene is judged, too, and that it was not counted with")
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel of pictures (64)")
    parser.add_argument("--count-spp", type=int, default=64, help="samples a pixel that are counted (64)")
    parser.add_argument("--depth", type=int, default=6, help="how many edges of a path are counted (6)")
    parser.add_argument("--flip", type=float, default=0.01, help="mean FLIP that the picture may be off by (0.01)")
    parser.add_argument("--delta-e", default="2,1,0.5,0.2",
                        help="budgets that are tried in turn: mean Delta E of what is read of a material (2,1,0.5,0.2)")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba, a compiled one (llvm_ad_rgb)")
    parser.add_argument("--program", help="the trilobe to run; by default the one beside this Python, or on the PATH")
    given, flags = parser.parse_known_args(arguments)
    if unknown := [flag for flag in flags if not flag.startswith("--")]:
        raise Error(f"unknown argument '{unknown[0]}'; flags of `trilobe fit --scene` begin with --")
    try:
        budgets = [float(text) for text in given.delta_e.split(",")]
    except ValueError:
        raise Error(f"--delta-e={given.delta_e} are no numbers; give some as 2,1,0.5") from None
    for name in ("spp", "count_spp", "depth"):
        if not 1 <= getattr(given, name) <= 1 << 20:
            raise Error(f"--{name.replace('_', '-')} must be from 1 to {1 << 20}")
    options = Options(
        given.spp, given.count_spp, given.depth, given.flip, budgets, _pairs("-D", given.D),
        _pairs("--moved", given.moved), given.program, flags)
    _set_variant(given.variant)
    return Path(given.scene), Path(given.out), options


def _pairs(flag: str, texts: list[str]) -> dict[str, str]:
    for text in texts:
        if "=" not in text:
            raise Error(f"{flag} {text}: give NAME=VALUE")
    return dict(text.split("=", 1) for text in texts)


def _set_variant(variant: str) -> None:
    try:
        import flip_evaluator  # noqa: F401

        from trilobe._mitsuba.renderer import mi
    except ImportError as error:
        raise Error(f"trilobe-need needs {error.name}: pip install 'trilobe[need]'") from None
    if not hasattr(mi, "parser"):
        raise Error(f"trilobe-need needs Mitsuba 3.7 or newer, not {mi.__version__}: pip install -U mitsuba")
    if variant not in mi.variants() or variant.startswith("scalar") or not variant.endswith("_rgb"):
        raise Error(f"--variant={variant} is no compiled variant for RGB; give llvm_ad_rgb or cuda_ad_rgb")
    mi.set_variant(variant)
    import trilobe.mitsuba  # noqa: F401


def main(arguments: list[str] | None = None) -> int:
    """The command."""
    try:
        path, out, options = _parsed_options(arguments)
        if not path.is_file():
            raise Error(f"cannot read '{path}'")
        need(path, out, options, lambda line: print(line, flush=True))
    except (Error, OSError, RuntimeError) as error:
        line = str(error).strip().splitlines()
        print(f"trilobe-need: error: {line[0] if line else type(error).__name__}", file=sys.stderr)
        return 1
    print(f"wrote {out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
