"""BSDFs for Mitsuba 3, which importing this registers, for all variants that are set from then on.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import trilobe.mitsuba

    mi.load_dict({"type": "sphere", "bsdf": {"type": "trilobe", "filename": "model.json"}})
    mi.load_dict({"type": "sphere", "bsdf": trilobe.mitsuba.bsdf(brdf)})
    mi.load_dict({"type": "sphere", "bsdf": {"type": "trilobe_measured", "filename": "material.binary"}})

They reflect on the front side; put them into a `twosided` for both. They are for all variants; polarised light is
depolarised. In those that compile, tables are Dr.Jit arrays, and no Python runs for a ray. In scalar variants each
ray calls Python, which is exact, but some 25 times as slow as Mitsuba's `measured` of the file that
`trilobe.convert(brdf, "model.bsdf")` writes.

`trilobe` is a fitted model of any form, isotropic or anisotropic. Its tables can be optimised: ``mi.traverse(scene)``
has d, s, D, F and G of it. Parameters: `filename`, a model file or "material:NAME", or `json`, the text of one;
`update_sampling` (true), whether what is drawn follows tables that are optimised.

`trilobe_measured` is a measurement of any format: what was measured, at its bins or nodes; between them, and where
nothing was, by help of a fitted model, and drawn by that. Samples that stand at no grid are the model. Parameters:
`filename`, the measurement, or a model, which is then all; `model`, a model file, without which one is fitted, in
seconds.

Both take `sampling`, another model file to draw directions by, so that pictures of several models have the same noise.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from trilobe._fitting.measurement import completed, is_model, read
from trilobe._model.brdf import Brdf, load, model_of
from trilobe._model.error import Error

try:
    from trilobe._mitsuba.renderer import dr, mi
except ImportError:
    raise ImportError("trilobe.mitsuba needs Mitsuba 3: pip install mitsuba") from None

if tuple(int(part) for part in mi.__version__.split(".")[:2]) < (3, 6):
    raise ImportError(f"trilobe.mitsuba needs Mitsuba 3.6 or newer, not {mi.__version__}: pip install -U mitsuba")

from trilobe._mitsuba.albedo import Albedo
from trilobe._mitsuba.measured import MeasuredTable
from trilobe._mitsuba.one import OnePair, row
from trilobe._mitsuba.sampling import Sampling
from trilobe._mitsuba.tables import Tables
from trilobe._mitsuba.upsampling import Upsampling

__all__ = ["bsdf"]

_CLASSES: dict[str, Any] = {}


def bsdf(brdf: Brdf | str | os.PathLike[str], **parameters: Any) -> dict[str, Any]:
    """The material's dictionary for `mi.load_dict`, from a model, the path of one, or material:NAME."""
    return {"type": "trilobe", "json": model_of(brdf).to_json(), **parameters}


def _path_of(props: Any, name: str) -> str:
    """A path as scenes give it, beside the scene file."""
    path = str(props[name])
    return path if path.startswith(("material:", "synth:")) else str(mi.file_resolver().resolve(path))


def _brdf_of(props: Any) -> Brdf:
    given = [name for name in ("filename", "json") if name in props]
    if len(given) != 1:
        raise Error("a trilobe BSDF needs either filename, a model file, or json, its text")
    if given[0] == "json":
        return Brdf.from_json(str(props["json"]), "the BSDF's json")
    return load(_path_of(props, "filename"))


def fit_to_help(measurement: Any) -> Brdf:
    """The model by whose help a measurement is a function of all directions, as `trilobe convert` fits it."""
    from trilobe._fitting.fit import fit

    return fit(measurement, max_iterations=4, match_reflectance=False, progress=False).model


def _define() -> Any:
    """The BSDFs of the current variant, by name."""
    compiled = dr.is_jit_v(mi.Float)

    class Trilobe(mi.BSDF):  # type: ignore[misc]
        """A fitted model (trilobe.mitsuba)."""

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            self._brdf = _brdf_of(props)
            self._set_up(props)
            self.d = mi.TensorXf(np.asarray(self._brdf.d, np.float32))
            self.s = mi.TensorXf(np.asarray(self._brdf.s, np.float32))
            self.D, self.F, self.G = (
                mi.TensorXf(np.asarray(getattr(self._brdf, name), np.float32)) for name in "DFG"
            )
            if compiled:
                self._tables = Tables(self._brdf)
                self._fill()

        def _set_up(self, props: Any) -> None:
            """Sets the model to draw from, and the flags for the renderer."""
            other = load(_path_of(props, "sampling")) if "sampling" in props else None
            self._follows = bool(props.get("update_sampling", True)) and other is None
            self._drawn = other or self._brdf
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if self._brdf.anisotropic:
                flags = flags | mi.BSDFFlags.Anisotropic
            self.m_components = [flags]
            self.m_flags = flags
            self._albedo: Albedo | None = None  # until it is asked for, as it takes up to seconds
            self._colours = Upsampling() if mi.is_spectral else None
            if compiled:
                self._sampling = Sampling(self._drawn)
            else:
                self._set_pairs()

        def _set_pairs(self) -> None:
            self._pair, self._drawn_pair = OnePair(self._brdf), OnePair(self._drawn)
            self._is_drawn = self._drawn is self._brdf  # and a sample's weight is the model's

        def _fill(self) -> None:
            tables = {name: getattr(self, name).array for name in "DFG"}
            self._tables.fill(self.d.array, self.s.array, tables)

        def _value(self, wi: Any, wo: Any, active: Any) -> Any:
            """f [1/sr] of directions above the surface."""
            return self._tables.value(wi, wo, active)

        def _value_of_one(self, wi: Any, wo: Any) -> Any:
            """The same of two rows (1, 3), 0 below the surface."""
            return self._pair.eval(wi, wo)

        def traverse(self, callback: Any) -> None:
            for name in ("d", "s", "D", "F", "G") if self._brdf.lobes > 0 else ("d",):
                callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Any = ()) -> None:
            if compiled:
                self._fill()
            if self._follows or not compiled:
                parts = {
                    name: np.maximum(np.nan_to_num(np.array(dr.detach(getattr(self, name)), np.float64)), 0)
                    for name in (("d", "s", "D", "F", "G") if self._brdf.lobes > 0 else ("d",))
                }
                self._brdf = self._brdf.replace(**parts)
                self._albedo = None
                if self._follows:
                    self._drawn = self._brdf
                if compiled and self._follows:
                    self._sampling = Sampling(self._brdf)
                if not compiled:
                    self._set_pairs()

        # Methods of all variants.

        def _spectrum(self, si: Any, colour: Any) -> Any:
            if self._colours is not None:
                value = self._colours(colour, si.wavelengths)
            elif mi.is_monochromatic:
                value = mi.Color1f(mi.luminance(colour))
            else:
                value = mi.Color3f(colour)
            return mi.depolarizer(value) if mi.is_polarized else value

        def _both(self, si: Any, wo: Any, active: Any) -> tuple[Any, Any]:
            """The value times cos theta_o, and the density."""
            wi = si.wi
            if not compiled:
                one_wi, one_wo = row(wi), row(wo)
                value = self._value_of_one(one_wi, one_wo) * max(wo.z, 0)
                return self._spectrum(si, mi.Color3f(value)), self._drawn_pair.pdf(one_wi, one_wo)
            active = active & (wi.z > 0) & (wo.z > 0)
            colour = self._value(wi, wo, active) * wo.z
            with dr.suspend_grad():
                wi, wo = dr.detach(wi), dr.detach(wo)
                pdf = self._sampling.pdf(wi, wo, self._sampling.incident(wi), active)
            return dr.select(active, self._spectrum(si, colour), 0), dr.select(active, pdf, 0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            wi = si.wi
            if not compiled:
                return self._spectrum(si, mi.Color3f(self._value_of_one(row(wi), row(wo)) * max(wo.z, 0)))
            active = active & (wi.z > 0) & (wo.z > 0)
            colour = self._value(wi, wo, active) * wo.z
            return dr.select(active, self._spectrum(si, colour), 0)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            wi = si.wi
            if not compiled:
                return self._drawn_pair.pdf(row(wi), row(wo))
            active = active & (wi.z > 0) & (wo.z > 0)
            with dr.suspend_grad():
                wi, wo = dr.detach(wi), dr.detach(wo)
                pdf = self._sampling.pdf(wi, wo, self._sampling.incident(wi), active)
            return dr.select(active, pdf, 0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self._both(si, wo, active)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            drawn = mi.BSDFSample3f()
            drawn.eta = 1
            drawn.sampled_component = mi.UInt32(0)
            drawn.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            if not compiled:
                wi = row(si.wi)
                of_model = self._drawn_pair.sample(wi, sample2)
                wo, pdf, weight = of_model[:3], float(of_model[3]), of_model[4:]
                drawn.wo, drawn.pdf = mi.Vector3f(wo), pdf
                if not self._is_drawn:
                    weight = self._value_of_one(wi, wo[None]) * (wo[2] / pdf if pdf > 0 else 0)
                return drawn, self._spectrum(si, mi.Color3f(weight))
            active = active & (si.wi.z > 0)
            with dr.suspend_grad():
                wi = dr.detach(si.wi)
                at = self._sampling.incident(wi)
                wo = self._sampling.draw(wi, at, sample1, sample2, active)
                active &= wo.z > 0
                pdf = self._sampling.pdf(wi, wo, at, active)
                active &= pdf > 0
            drawn.wo = wo
            drawn.pdf = dr.select(active, pdf, 0)
            colour = self._value(si.wi, wo, active) * (wo.z / drawn.pdf)
            return drawn, dr.select(active, self._spectrum(si, colour), 0)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            """The share of light that is reflected, in the integrator's `albedo` picture."""
            if self._albedo is None:
                self._albedo = Albedo(self._brdf)
            if not compiled:
                return self._spectrum(si, mi.Color3f(self._albedo.of_one(float(si.wi.z))))
            active = active & (si.wi.z > 0)
            return dr.select(active, self._spectrum(si, self._albedo(si.wi.z, active)), 0)

        def to_string(self) -> str:
            return f"Trilobe[{self._brdf!r}]"

    class TrilobeMeasured(Trilobe):
        """A measurement, drawn by a fitted model (trilobe.mitsuba)."""

        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            if "filename" not in props:
                raise Error("a trilobe_measured BSDF needs filename, a measurement of any format")
            path = _path_of(props, "filename")
            self._completed = None
            if is_model(path):
                self._brdf = load(path)
                measurement = None
            else:
                measurement = read(path)
                self._brdf = load(_path_of(props, "model")) if "model" in props else fit_to_help(measurement)
            self._set_up(props)
            if compiled:
                self._table = MeasuredTable(measurement, self._brdf)
            elif measurement is not None:
                self._completed = completed(measurement, self._brdf)
                self._is_drawn = False

        def _value(self, wi: Any, wo: Any, active: Any) -> Any:
            return self._table.value(wi, wo, active)

        def _value_of_one(self, wi: Any, wo: Any) -> Any:
            if self._completed is None:
                return self._pair.eval(wi, wo)
            return self._completed.eval(wi.astype(np.float64), wo.astype(np.float64))[0]

        def traverse(self, callback: Any) -> None:
            pass

        def parameters_changed(self, keys: Any = ()) -> None:
            pass

        def to_string(self) -> str:
            return f"TrilobeMeasured[{self._brdf!r}]"

    return {"trilobe": Trilobe, "trilobe_measured": TrilobeMeasured}


def _register(*_: Any) -> None:
    variant = mi.variant()
    if variant is None or variant in _CLASSES:
        return
    _CLASSES[variant] = _define()
    for name, kind in _CLASSES[variant].items():
        mi.register_bsdf(name, kind)


_register()
mi.detail.add_variant_callback(_register)
