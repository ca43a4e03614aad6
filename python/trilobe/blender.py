"""An importer for Blender: the nearest Principled BSDF that `trilobe convert MODEL --out=NAME.principled.json` finds.

In Blender, Edit > Preferences > Add-ons > Install from Disk takes this file alone; it needs nothing but Blender 4.0 or
newer. File > Import > Trilobe then makes a material of each file, and gives the last one to the selected objects. In
scripts, `import_material` does the same:

    import sys; sys.path.append("python/trilobe")  # or: from trilobe import blender
    import blender
    material = blender.import_material("plastic.principled.json")
"""

from __future__ import annotations

import json
import pathlib
from typing import Any

import bpy
from bpy_extras.io_utils import ImportHelper

bl_info = {
    "name": "Trilobe materials",
    "author": "The Trilobe authors",
    "version": (0, 2, 0),
    "blender": (4, 0, 0),
    "location": "File > Import > Trilobe (.principled.json)",
    "description": "Materials of measured reflectance, as Principled BSDFs",
    "category": "Import-Export",
}
FORMAT = "blender-principled"


def read(path: str | pathlib.Path) -> dict[str, Any]:
    """The content of a file. Raises ValueError, with the file and what is wrong."""
    try:
        content = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: cannot be read as JSON: {error}") from error
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ValueError(f"{path}: is no .principled.json; trilobe convert MODEL --out=NAME.principled.json writes one")
    inputs = content.get("inputs")
    if not isinstance(inputs, dict) or not all(_is_value(value) for value in inputs.values()):
        raise ValueError(f"{path}: its inputs are not numbers and colours; write it anew by trilobe convert")
    return content


def _is_value(value: Any) -> bool:
    if isinstance(value, list):
        return len(value) == 4 and all(isinstance(x, (int, float)) for x in value)
    return isinstance(value, (int, float))


def import_material(path: str | pathlib.Path) -> Any:
    """A new material, a `bpy.types.Material` of one Principled BSDF.

    Its custom properties `trilobe_made`, `trilobe_error` and `trilobe_lost` say what of, and how near it is, and
    `trilobe_missing` which inputs this version of Blender lacks. Raises ValueError as `read` does.
    """
    content = read(path)
    material = bpy.data.materials.new(str(content.get("name", "Trilobe")))
    if bpy.app.version < (5, 0, 0):  # always so since
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    bsdf = tree.nodes.new("ShaderNodeBsdfPrincipled")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (320, 0)
    tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    missing = []
    for name, value in content["inputs"].items():
        if name in bsdf.inputs:
            bsdf.inputs[name].default_value = value
        else:
            missing.append(name)
    if content["inputs"].get("Anisotropic", 0) > 0:
        # Along x: around the object's own z axis, until it has a UV map that says otherwise.
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.location = (-240, -200)
        tree.links.new(tangent.outputs["Tangent"], bsdf.inputs["Tangent"])
    for key in ("made", "error", "lost"):
        material[f"trilobe_{key}"] = str(content.get(key, ""))
    material["trilobe_missing"] = ", ".join(missing)
    return material


class ImportTrilobe(bpy.types.Operator, ImportHelper):  # type: ignore[misc]
    """Import materials of measured reflectance."""

    bl_idname = "import_scene.trilobe"
    bl_label = "Import Trilobe materials"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".principled.json"
    filter_glob: bpy.props.StringProperty(default="*.principled.json", options={"HIDDEN"})  # type: ignore[valid-type]
    files: bpy.props.CollectionProperty(type=bpy.types.OperatorFileListElement)  # type: ignore[valid-type]
    directory: bpy.props.StringProperty(subtype="DIR_PATH")  # type: ignore[valid-type]

    def execute(self, context: Any) -> set[str]:
        """Imports what was chosen; the last material goes to the selected objects."""
        folder = pathlib.Path(self.directory)
        paths = [folder / file.name for file in self.files if file.name] or [pathlib.Path(self.filepath)]
        material = None
        for path in paths:
            try:
                material = import_material(path)
            except ValueError as error:
                self.report({"ERROR"}, str(error))
                return {"CANCELLED"}
            self.report({"INFO"}, f"{material.name}: {material['trilobe_error']}")
            if material["trilobe_missing"]:
                self.report({"WARNING"}, f"this Blender lacks {material['trilobe_missing']}")
        for selected in context.selected_objects:
            if hasattr(selected.data, "materials"):
                selected.active_material = material
        return {"FINISHED"}


def _add_to_menu(menu: Any, _: Any) -> None:
    menu.layout.operator(ImportTrilobe.bl_idname, text="Trilobe (.principled.json)")


def register() -> None:
    """Called by Blender when the add-on is switched on."""
    bpy.utils.register_class(ImportTrilobe)
    bpy.types.TOPBAR_MT_file_import.append(_add_to_menu)


def unregister() -> None:
    """Called by Blender when the add-on is switched off."""
    bpy.types.TOPBAR_MT_file_import.remove(_add_to_menu)
    bpy.utils.unregister_class(ImportTrilobe)
