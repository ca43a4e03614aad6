"""Inputs of the Principled BSDF that `convert` writes, rendered by Blender beside the model that Mitsuba renders.

Skips without bpy (PyPI, 0.4 GB), which no script installs.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import run

SIZE, SUN, TOWARDS = 64, 3.0, np.array([1.0, 1.0, 2.0]) / 6**0.5


def by_mitsuba(mi: Any, tensor: Path) -> NDArray[np.float64]:
    """A sphere from afar, under a sun without a size."""
    mi.set_variant("scalar_rgb")
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 2, "hide_emitters": True},
        "sensor": {"type": "orthographic", "near_clip": 0.1, "far_clip": 20,
                   "to_world": mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"},
                            "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": "independent", "sample_count": 64}},
        "light": {"type": "directional", "direction": (-TOWARDS).tolist(),
                  "irradiance": {"type": "rgb", "value": [SUN, SUN, SUN]}},
        "sphere": {"type": "sphere", "bsdf": {"type": "measured", "filename": str(tensor)}}})
    return np.array(mi.render(scene, seed=1), dtype=np.float64)


def by_blender(bpy: Any, mi: Any, principled: Path, picture: Path) -> NDArray[np.float64]:
    """The same scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6)
    sphere = bpy.context.object
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("material")
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    for name, value in json.loads(principled.read_text())["inputs"].items():
        node.inputs[name].default_value = value
    sphere.data.materials.append(material)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = SUN, 0
    light = bpy.data.objects.new("sun", sun)
    light.rotation_mode = "QUATERNION"
    from mathutils import Vector
    light.rotation_quaternion = Vector(TOWARDS.tolist()).to_track_quat("Z", "Y")
    bpy.context.collection.objects.link(light)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 2
    eye = bpy.data.objects.new("camera", camera)
    eye.location = (0, 0, 5)
    bpy.context.collection.objects.link(eye)
    scene = bpy.context.scene
    scene.camera = eye
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)
    return np.array(mi.Bitmap(str(picture)), dtype=np.float64)[..., :3]


@pytest.mark.parametrize("source", ["synth:plastic", "synth:copper", "synth:felt"])
def test_blender_shows_what_the_file_says(mitsuba: Any, tmp_path: Path, source: str) -> None:
    bpy = pytest.importorskip("bpy", reason="bpy is not installed")
    run("fit", source, "--solver=awls", "--max_iterations=3", "--noplots", f"--out={tmp_path}")
    run("convert", tmp_path / "model.json", f"--out={tmp_path / 'x.principled.json'}")
    run("convert", tmp_path / "model.json", f"--out={tmp_path / 'x.bsdf'}", "--error=0.02")
    model = by_mitsuba(mitsuba, tmp_path / "x.bsdf")
    standard = by_blender(bpy, mitsuba, tmp_path / "x.principled.json", tmp_path / "x.exr")
    y, x = np.mgrid[:SIZE, :SIZE] * 2 / SIZE - 1 + 1 / SIZE
    within = x * x + y * y < 0.8
    model = model[within]
    standard = standard[within]
    off = np.abs(model - standard).sum() / model.sum()
    print(f"{source}: off by {100 * off:.1f} % of the light")
    assert off < 0.1
