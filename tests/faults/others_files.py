"""Files that the program has not written, in the place of those that a command writes: they stay.

A part of harness.py, which draws this fault with the others.
"""

import hashlib
import os
import shutil

QUICK = ["--solver=awls", "--max_iterations=2", "--lobes=1", "--max_angle=20"]


class Broken(Exception):
    """A promise that was not kept."""


def require(holds, what):
    if not holds:
        raise Broken(what)


def content(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def snapshot(folder):
    """Hashes of the files below a folder, by relative path."""
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = content(path)
    return found


def writing_commands(harness):
    """All commands that write files, {name: (words, what --out is in the room)}."""
    model, source = os.path.join(harness.model, "model.json"), "synth:felt@12x12x24"
    trace = "--trace=" + os.path.join(harness.model, "trace.csv")
    cache = "--cache=" + os.path.join(harness.room, "cache")
    commands = {
        "one": (["fit", source, *QUICK, "--plots", "--reconstruction", "--convergence"], "out"),
        "anisotropic": (["fit", "synth:linen@6x12", *QUICK, "--noplots", "--reconstruction"], "out"),
        "many": (["fit", source, "synth:rubber@12x12x24", *QUICK], "out"),
        "scene": (["fit", f"--scene={harness.scene}", *QUICK, cache], "out"),
        "study": (["study", source, "--solvers=awls,lm", "--runs=1", "--max_iterations=2", "--nodiagnose"], "out"),
        "plot": (["plot", model, source, trace], "out"),
        "info": (["info", source], "out"),
        "score": (["score", model, source], "out/seen.png"),
        "compare": (["compare", harness.scene, *QUICK, cache], "out/trade_off.png"),
        "view": (["view", model, source], "out/page.html"),
    }
    for ending in ("binary", "csv", "bsdf", "zemax.bsdf", "xml", "xompt", "glsl", "hlsl", "mtlx", "principled.json",
                   "gltf", "usda"):
        more = {"csv": ["--max_angle=30"], "mtlx": ["--picture"]}.get(ending, [])
        commands["convert." + ending] = (["convert", model, *more], "out/felt." + ending)
    for material, ending in (("felt", "binary"), ("linen", "bin"), ("felt@6x12", "csv")):
        commands["synth." + ending] = (["synth", material], "out/felt." + ending)
    return commands


def trial(harness):
    """Somebody else's files lie where a command writes its own, alone or beside an earlier result."""
    commands = writing_commands(harness)
    kind = harness.random.choice(sorted(commands))
    words, out = commands[kind]
    folder = os.path.join(harness.room, "out")
    os.makedirs(folder)
    words = [*words, "--out=" + os.path.join(harness.room, out)]
    harness.succeed(words)
    names = sorted(snapshot(folder))
    require(names, f"{kind} writes nothing")
    harness.succeed(words)  # its own files are not in its way
    require(sorted(snapshot(folder)) == names, f"{kind} writes other files when it is run again")
    alone = harness.random.random() < 0.4
    own = os.path.join(harness.room, "own")
    shutil.copytree(folder, own)
    if alone:
        shutil.rmtree(folder)
    for victims in [*([name] for name in names), names]:
        for name in victims:
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb") as file:
                file.write(content_of_others(harness, name))
        before = snapshot(folder)
        status, _, err = harness.run(words)
        require(snapshot(folder) == before, f"{kind} touched what was in its way: {victims}")
        require(status == 1 and err.count("\n") == 1, f"{kind} with {victims} in its way: status {status}, {err}")
        require(any(f"'{os.path.join(folder, name)}'" in err for name in victims),
                f"{kind} does not name {victims}: {err}")
        if victims == names:
            break
        os.remove(path)
        if not alone:
            shutil.copy(os.path.join(own, name), path)
    harness.succeed([*words, "--force"])
    require(set(names) <= set(snapshot(folder)), f"{kind} --force has not written all of {names}")
    harness.succeed(words)
    return f"{kind}, {'alone' if alone else 'beside a result'}"


def content_of_others(harness, name):
    """Something that the program has not written, as a file of this name may be, or not."""
    usual = {
        ".json": b'{"tool": "other", "files": ["view.html"], "run": 7}', ".csv": b"name,value\ncopper,1\n",
        ".html": b"<!doctype html>\n<title>Mine</title>\n<p>Trilobe is a program.</p>\n", ".pdf": b"%PDF-1.7\n%%EOF\n",
        ".svg": b'<svg xmlns="http://www.w3.org/2000/svg"></svg>\n', ".txt": b"material: to be bought\n",
        ".png": b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3a\x7e\x9b\x55\0\0\0\0IEND\xaeB`\x82"}
    ending = os.path.splitext(name)[1]
    if ending == ".binary" and harness.random.random() < 0.7:
        with open(harness.source, "rb") as file:
            return file.read()
    if ending == ".bin" and harness.random.random() < 0.7:
        return bytes(3 * 8 * 288 * 288)
    return harness.random.choice([usual.get(ending, b"mine"), b"mine", b"{}", harness.random.randbytes(5000)])
