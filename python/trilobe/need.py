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
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._batch import find_program
from trilobe._brdf import Brdf, load, write_text
from trilobe._core import Error
from trilobe._fitting import fit
from trilobe._measurement import Measurement, is_model, read
from trilobe._need_page import left_text, page, totals

_MERL = (90, 90, 180)
_COVERAGE = 0.999  # of what is read; the directions of the rest are not used
_KINDS = ("trilobe", "trilobe_measured")


class Options(NamedTuple):
    """How it is done; `main` has the defaults."""

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
        """Of the file of the measurement."""
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
        import mitsuba as mi

        config = mi.parser.ParserConfig(mi.variant())
        config.merge_equivalent = config.merge_meshes = False
        state = mi.parser.parse_file(config, str(self._path), **self._parameters)
        mi.parser.transform_all(config, state)
        return state

    def load(self, replaced: dict[str, dict[str, str]]) -> Any:
        """The scene, with other BSDFs for some materials: their properties, and `type`."""
        import mitsuba as mi

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
        import mitsuba as mi

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


# What the program reads.


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
    """Between bins, each is read with its neighbours; and both sides of the plane of incidence are the same."""
    bins = (bins + bins[..., ::-1]) / 2
    for axis, ends in ((0, "edge"), (1, "edge"), (2, "wrap")):
        width = [(1, 1) if k == axis else (0, 0) for k in range(3)]
        wide = np.moveaxis(np.pad(bins, width, mode=ends), axis, 0)  # type: ignore[call-overload]
        bins = np.moveaxis((wide[:-2] + 2 * wide[1:-1] + wide[2:]) / 4, 0, axis)
    return bins


def _write_scene(materials: list[Material], counts: list[Any], budget: float, folder: Path) -> Path:
    entries = [
        {"name": material.name, "source": material.source, "directions": _directions(material, count, folder)}
        for material, count in zip(materials, counts)
        if count.bins.sum() > 0
    ]
    text = {"format": "trilobe-scene", "version": 1, "budget": {"mean_delta_e": budget}, "materials": entries}
    path = folder / "scene.json"
    write_text(path, json.dumps(text, indent=1) + "\n")
    return path


def _fit_scene(scene: Path, out: Path, options: Options) -> dict[str, Any]:
    command = [find_program(options.program), "fit", f"--scene={scene}", f"--out={out}", *options.flags]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        raise Error(lines[-1].removeprefix("trilobe: ") if lines else f"trilobe ended with {done.returncode}")
    plan: dict[str, Any] = json.loads((out / "plan.json").read_text())
    return plan


# Pictures.


class Picture(NamedTuple):
    """A rendered scene."""

    linear: NDArray[np.float64]
    seconds: float


def _render(scene: Any, spp: int) -> Picture:
    import drjit as dr
    import mitsuba as mi

    dr.eval(mi.render(scene, spp=1))  # compiles
    begin = time.perf_counter()
    image = np.array(mi.render(scene, spp=spp, seed=1), np.float64)[..., :3]
    return Picture(image, time.perf_counter() - begin)


def shown(linear: NDArray[np.float64], white: float) -> NDArray[np.float32]:
    """sRGB, 0 to 1, of linear light."""
    x = np.clip(np.nan_to_num(linear) / white, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(np.float32)


def _lab(linear: NDArray[np.float64], white: float) -> NDArray[np.float64]:
    """CIELAB under D65 (CIE 15:2004)."""
    x = np.clip(np.nan_to_num(linear) / white, 0, 1)
    xyz = x @ np.array([[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]])
    t = xyz / [0.95047, 1, 1.08883]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    lab: NDArray[np.float64] = np.stack(
        [116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], axis=-1)
    return lab


class Difference(NamedTuple):
    """How far two pictures are apart."""

    flip: float
    delta_e: float
    map: NDArray[np.float32]


def difference(reference: NDArray[np.float64], test: NDArray[np.float64], white: float) -> Difference:
    """Mean FLIP (Andersson et al. 2020) with its map, and the mean CIELAB difference."""
    import flip_evaluator

    heat, mean, _ = flip_evaluator.evaluate(shown(reference, white), shown(test, white), "LDR")
    delta_e = np.linalg.norm(_lab(reference, white) - _lab(test, white), axis=-1)
    return Difference(float(mean), float(delta_e.mean()), np.asarray(heat, np.float32))


def _write_png(path: Path, srgb: NDArray[np.float32]) -> None:
    import mitsuba as mi

    bytes_of = (np.clip(srgb, 0, 1) * 255 + 0.5).astype(np.uint8)
    mi.Bitmap(np.ascontiguousarray(bytes_of)).write(str(path))


# The whole.


def need(path: Path, out: Path, options: Options, tell: Any = print) -> dict[str, Any]:
    """Does it all, and returns what `need.json` has."""
    from trilobe._need_count import Counter

    for folder in (out, out / "full", out / "pruned"):
        folder.mkdir(parents=True, exist_ok=True)
    file = SceneFile(path, options.parameters)
    moved = SceneFile(path, {**options.parameters, **options.moved}) if options.moved else None
    for material in file.materials:
        material.prepare(out / "full")
        tell(f"{material.name}: {material.source}, fitted in {material.fit_seconds:.1f} s")

    def materials_of(kind: str) -> dict[str, dict[str, str]]:
        return {material.name: _bsdf(material, kind, out) for material in file.materials}

    measured_scene = file.load(materials_of("measured"))
    measured = _render(measured_scene, options.spp)
    white = max(float(np.quantile(measured.linear @ [0.2126, 0.7152, 0.0722], 0.98)), 1e-12)
    counter = Counter(
        measured_scene, file.sides(measured_scene), [material.grid for material in file.materials], options.depth)
    begin = time.perf_counter()
    counts = counter.count(measured.linear, options.count_spp, seed=2)
    tell(f"counted in {time.perf_counter() - begin:.1f} s")

    full = _render(file.load(materials_of("full")), options.spp)
    of_full = difference(measured.linear, full.linear, white)
    tell(f"full models: FLIP {of_full.flip:.4f}, Delta E {of_full.delta_e:.3f}")
    tries = []
    for budget in options.budgets:
        scene_file = _write_scene(file.materials, counts, budget, out)
        plan = _fit_scene(scene_file, out / "pruned", options)
        pruned = _render(file.load(materials_of("pruned")), options.spp)
        of_pruned = difference(measured.linear, pruned.linear, white)
        parameters = sum(entry["parameters"]["pruned"] for entry in plan["materials"])
        tries.append({"mean_delta_e": budget, "parameters": parameters, "flip": of_pruned.flip})
        tell(f"pruned to {parameters} parameters, a sphere's Delta E at most {budget}: FLIP {of_pruned.flip:.4f}, "
             f"Delta E {of_pruned.delta_e:.3f}")
        if of_pruned.flip <= options.flip:
            break
    pictures = {"measured": measured, "full": full, "pruned": pruned}
    differences = {"full": of_full, "pruned": of_pruned}
    if moved is not None:
        away = {kind: _render(moved.load(materials_of(kind)), options.spp) for kind in pictures}
        pictures.update({f"moved_{kind}": picture for kind, picture in away.items()})
        for kind in ("full", "pruned"):
            differences[f"moved_{kind}"] = difference(away["measured"].linear, away[kind].linear, white)
            tell(f"moved, {kind}: FLIP {differences[f'moved_{kind}'].flip:.4f}")
    images = {name: shown(picture.linear, white) for name, picture in pictures.items()}
    images.update({f"{name}_flip": apart.map for name, apart in differences.items()})
    rows = [[images[prefix + name] for name in ("measured", "pruned", "pruned_flip")]
            for prefix in ("", "moved_") if prefix + "measured" in images]
    images["overview"] = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    for name, image in images.items():
        _write_png(out / f"{name}.png", image)
    report = _report(path, options, file.materials, counts, plan, tries, pictures, differences)
    write_text(out / "need.json", json.dumps(report, indent=1) + "\n")
    write_text(out / "index.html", page(report))
    tell(left_text(report["totals"]))
    return report


def _bsdf(material: Material, kind: str, out: Path) -> dict[str, str]:
    """The BSDF of a material; all are drawn by the same model, so that noise is the same."""
    whole = str((out / "full" / f"{material.name}.json").resolve())
    pruned = out / "pruned" / f"{material.name}.json"
    if kind == "measured" and material.measurement is not None:
        return {"type": "trilobe_measured", "filename": material.source, "model": whole}
    if kind == "pruned" and pruned.exists():  # one that is never seen is not fitted
        return {"type": "trilobe", "filename": str(pruned.resolve()), "sampling": whole}
    return {"type": "trilobe", "filename": whole}


def _report(
    path: Path, options: Options, materials: list[Material], counts: list[Any], plan: dict[str, Any],
    tries: list[dict[str, Any]], pictures: dict[str, Picture], differences: dict[str, Difference],
) -> dict[str, Any]:
    planned = {entry["name"]: entry for entry in plan["materials"]}
    rows = []
    for material, count in zip(materials, counts):
        entry = planned.get(material.name)
        row: dict[str, Any] = {
            "name": material.name, "source": os.path.basename(material.source), "share": float(count.bins.sum()),
            "measured_bytes": material.bytes, "parameters": {"full": 0, "pruned": 0},
            "seconds": {"full": material.fit_seconds, "pruned": 0.0},
        }
        if entry is not None:
            row["parameters"] = entry["parameters"]
            row["seconds"]["pruned"] = entry["seconds"]["fit"] + entry["seconds"]["prune"]
            row["samples"] = entry["samples"]
            row["verdict"] = entry["verdict"]
        rows.append(row)
    seconds = {name: picture.seconds for name, picture in pictures.items()}
    return {
        "totals": totals(rows, seconds),
        "scene": path.name, "parameters": options.parameters, "moved": options.moved, "spp": options.spp,
        "materials": rows, "tries": tries,
        "pictures": {name: {"seconds": value} for name, value in seconds.items()},
        "differences": {name: {"flip": d.flip, "delta_e": d.delta_e} for name, d in differences.items()},
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
                        help="budgets that are tried in turn: mean Delta E of each material's sphere (2,1,0.5,0.2)")
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
        import mitsuba as mi
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
