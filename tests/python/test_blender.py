"""The importer for Blender, in Blender as a module: pip install bpy."""

import json

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
from trilobe import blender  # noqa: E402

INPUTS = {"Base Color": [0.2, 0.4, 0.6, 1], "Metallic": 0.25, "Roughness": 0.3, "Anisotropic": 0.5,
          "Anisotropic Rotation": 0.25, "Coat Weight": 0.125}


@pytest.fixture(autouse=True)
def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def written(path, **changes):
    content = {"format": "blender-principled", "name": "gold", "error": "Delta E is 1.1", "inputs": INPUTS}
    path.write_text(json.dumps({**content, **changes}))
    return path


def bsdf_of(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def test_a_material_has_the_inputs_of_the_file(tmp_path):
    material = blender.import_material(written(tmp_path / "a.principled.json"))
    bsdf = bsdf_of(material)
    assert material.name == "gold" and material["trilobe_error"] == "Delta E is 1.1"
    np.testing.assert_allclose(bsdf.inputs["Base Color"].default_value, INPUTS["Base Color"], rtol=1e-6)
    for name in ("Metallic", "Roughness", "Anisotropic", "Anisotropic Rotation", "Coat Weight"):
        assert bsdf.inputs[name].default_value == pytest.approx(INPUTS[name])
    assert bsdf.inputs["Tangent"].is_linked and bsdf.outputs["BSDF"].is_linked


def test_what_this_blender_lacks_is_told(tmp_path):
    path = written(tmp_path / "a.principled.json", inputs={"Metallic": 1.0, "Warmth": 2.0})
    assert blender.import_material(path)["trilobe_missing"] == "Warmth"


@pytest.mark.parametrize(("changes", "words"), [
    ({"format": "other"}, "is no .principled.json"),
    ({"inputs": {"Roughness": "much"}}, "are not numbers"),
    ({"inputs": [1, 2]}, "are not numbers"),
])
def test_other_files_are_refused(tmp_path, changes, words):
    with pytest.raises(ValueError, match=words):
        blender.import_material(written(tmp_path / "a.principled.json", **changes))
    (tmp_path / "b.principled.json").write_bytes(b"\xff{")
    with pytest.raises(ValueError, match="cannot be read as JSON"):
        blender.import_material(tmp_path / "b.principled.json")
    assert not bpy.data.materials


def test_the_menu_gives_the_material_to_selected_objects(tmp_path):
    blender.register()
    try:
        bpy.ops.mesh.primitive_cube_add()
        path = written(tmp_path / "a.principled.json")
        result = bpy.ops.import_scene.trilobe(directory=str(tmp_path), files=[{"name": path.name}], filepath=str(path))
        assert result == {"FINISHED"} and bpy.context.object.active_material.name == "gold"
    finally:
        blender.unregister()
