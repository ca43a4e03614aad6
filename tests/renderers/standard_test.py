"""Standard materials that `convert` writes, in MaterialX and in Mitsuba's `principled`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import run


def test_materialx_takes_the_document(files: Path) -> None:
    mx = pytest.importorskip("MaterialX", reason="MaterialX is not installed")
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    for model in ("plastic", "metal"):
        path = files / f"{model}.mtlx"
        said = run("convert", files / f"{model}.json", f"--out={path}")
        document = mx.createDocument()
        mx.readFromXmlFile(document, str(path))
        document.importLibrary(library)
        valid, message = document.validate()
        assert valid, message
        surface = document.getNode(f"{model}_surface")
        definition = surface.getNodeDef()
        assert definition is not None
        for given in surface.getInputs():
            known = definition.getActiveInput(given.getName())
            assert known is not None, given.getName()
            assert known.getType() == given.getType()
        # How near it is stands in the file as it is said.
        error = said.split("sphere ")[1].split(";")[0]
        assert error in surface.getAttribute("doc")


def test_mitsubas_principled_is_as_bright_as_the_model(mitsuba: Any, files: Path) -> None:
    """A metal's parameters mean the same in both; Mitsuba's `clearcoat` and `spec_tint` do not."""
    mi = mitsuba
    run("fit", "synth:copper", "--solver=awls", "--max_iterations=3", "--noplots", f"--out={files / 'copper'}")
    model = files / "copper/model.json"
    principled, tensor = files / "copper.principled.json", files / "copper.bsdf"
    run("convert", model, f"--out={principled}")
    run("convert", model, f"--out={tensor}", "--error=0.05")
    inputs = json.loads(principled.read_text())["inputs"]
    assert inputs["Metallic"] > 0.9
    mi.set_variant("scalar_rgb")
    standard = mi.load_dict({
        "type": "principled", "metallic": inputs["Metallic"], "roughness": inputs["Roughness"],
        "base_color": {"type": "rgb", "value": inputs["Base Color"][:3]}, "eta": max(inputs["IOR"], 1.01)})
    measured = mi.load_dict({"type": "measured", "filename": str(tensor)})
    context, at = mi.BSDFContext(), mi.SurfaceInteraction3f()
    sums = np.zeros((2, 3))
    for theta_i in np.radians([5, 20, 35, 50]):
        at.wi = [math.sin(theta_i), 0, math.cos(theta_i)]
        for theta_o in np.radians(np.arange(2.5, 70, 5)):
            for phi in np.radians(np.arange(0, 360, 15)):
                wo = [math.sin(theta_o) * math.cos(phi), math.sin(theta_o) * math.sin(phi), math.cos(theta_o)]
                for k, bsdf in enumerate((standard, measured)):
                    sums[k] += np.array(bsdf.eval(context, at, wo)) * math.sin(theta_o)
    assert np.allclose(sums[0], sums[1], rtol=0.15), sums


def test_usd_takes_the_layer(files: Path) -> None:
    """All of USD's own validators have nothing to say, and its shader is found at the sphere."""
    validation = pytest.importorskip("pxr.UsdValidation", reason="usd-core is not installed")
    from pxr import Usd, UsdShade

    for model in ("plastic", "metal"):
        path = files / f"{model}.usda"
        said = run("convert", files / f"{model}.json", f"--out={path}")
        stage = Usd.Stage.Open(str(path))
        context = validation.ValidationContext(validation.ValidationRegistry().GetOrLoadAllValidators())
        assert [error.GetMessage() for error in context.Validate(stage)] == []
        bound = UsdShade.MaterialBindingAPI(stage.GetPrimAtPath("/World/Sphere")).ComputeBoundMaterial()[0]
        surface = bound.ComputeSurfaceSource()[0]
        assert surface.GetShaderId() == "UsdPreviewSurface"
        given = {value.GetBaseName(): value.Get() for value in surface.GetInputs()}
        assert f"metallic {given['metallic']:.3g}, roughness {given['roughness']:.3g} " in said
        assert said.split("sphere ")[1].split(";")[0] in stage.GetRootLayer().documentation
