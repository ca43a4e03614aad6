#!/usr/bin/env python3
"""Runs the cells of notebooks, without Jupyter, and keeps what they print and draw: run_notebook.py [--write] FILE...

Without --write nothing is kept; a cell that fails ends it either way.
"""

import argparse
import ast
import base64
import contextlib
import io
import json
import pathlib

import matplotlib

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402


def run_cell(source, names):
    """Runs a cell; returns its prints and pictures as a notebook has them. The last expression is shown."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None
        if value is not None and not hasattr(value, "savefig"):
            print(value)
    outputs = []
    if printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)})
    for number in pyplot.get_fignums():
        picture = io.BytesIO()
        pyplot.figure(number).savefig(picture, format="png", dpi=70)
        data = {"image/png": base64.b64encode(picture.getvalue()).decode()}
        outputs.append({"output_type": "display_data", "data": data, "metadata": {}})
    pyplot.close("all")
    return outputs


def run(path):
    """The notebook with the outputs of its cells."""
    notebook = json.loads(path.read_text())
    names, count = {}, 0
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            count += 1
            cell["outputs"] = run_cell("".join(cell["source"]), names)
            cell["execution_count"] = count
    return notebook


def main():
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="keep what cells print and draw in the file")
    parser.add_argument("files", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    for path in arguments.files:
        notebook = run(path)
        if arguments.write:
            path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
