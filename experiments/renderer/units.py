"""Units of experiments that make pictures."""
import importlib.util
import pathlib

from lab import UsageError, fits
from lab.units import FOLDER, Product, Unit

HERE = pathlib.Path(__file__).resolve().parent


def has_mitsuba():
    return importlib.util.find_spec("mitsuba") is not None


def require_mitsuba():
    """Raises UsageError without it."""
    if not has_mitsuba():
        raise UsageError("probes and meshes need Mitsuba: run experiments/renderer/setup, "
                         "then build/renderer/bin/python experiments/trilobe-experiments ...")


def modules(*names):
    """Files of this folder, as units count them."""
    return tuple(HERE / name for name in names)


def light_paths(setting, experiment, scene, words, seed):
    """The paths of a scene, a product. words: flags and Products, of `light_paths`."""
    counts = fits.words(setting.manifest["paths"][scene])
    return Product(Unit(f"{experiment}/paths/{scene}-{seed}", HERE / "light_paths",
                        (FOLDER, *words, f"--seed={seed}", *counts),
                        "paths.npz", modules=modules("scene.py", "light_lobes.py")),
                   "paths.npz")
