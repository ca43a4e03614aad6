"""The same random starts for all solvers: see README.md beside this file."""
import itertools
import json

from lab import fits
from lab.units import Unit


def units(setting):
    """Each way, on each material, in batches of starts, so that a run can stop between them. Ways of "few" make starts
    of their own and take only some of those that are given."""
    manifest, program = setting.manifest, setting.program("random_starts")
    made = []
    for batch, source, (way, own) in itertools.product(
            range(manifest["batches"]), setting.every(manifest["every"]), manifest["ways"].items()):
        few = way in manifest["few"]
        if few and batch:
            continue
        flags = {"solver": way, "starts": manifest["few_starts" if few else "starts"],
                 "first_seed": 1 + batch * manifest["starts"], **own, **setting.reading(source)}
        made.append(Unit(f"random_starts/{source.name}/{way}", program, (source.path, *fits.words(flags)),
                         labels={"material": source.name, "solver": way}))
    return made


def tabulate(setting, results):
    """A row for each start."""
    starts = []
    for result in results:
        if result.folder:
            lines = (result.folder / "stdout.txt").read_text().splitlines()
            starts += [{**result.labels, **json.loads(line)} for line in lines]
    return {"starts": starts}


def draw(drawn, _):
    return {}
