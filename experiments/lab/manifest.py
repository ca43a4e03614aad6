"""Manifests: what an experiment measures, and what a run of it was made with.

`experiments/NAME/manifest.json` holds the full form; its member `quick` replaces members of it for
the quick form, and its member `anisotropic`, where it has one, for that of anisotropic materials.
A run leaves a copy of what it used in its own folder, with machine, versions and
time.
"""
import datetime
import json
import pathlib
import re

from lab import UsageError, machine


FORMS = ("quick", "anisotropic")  # beside the full one
_LIST = re.compile(r"\[\s+([^\[\]{}]*?)\s+\]")


def _text(run):
    """JSON with an entry a line, and lists of numbers and words in one."""
    return _LIST.sub(lambda found: "[" + re.sub(r",\s*\n\s*", ", ", found[1]) + "]", json.dumps(run, indent=1)) + "\n"


def load(path, form="full", changes=()):
    """The settings of one form, "full" or one of FORMS, with changes
    ("flags.max_seconds=5", "runs.0.every=1"; values are JSON, or else text)."""
    full = json.loads(path.read_text())
    replaced = {name: full.pop(name) for name in FORMS if name in full}
    if form != "full" and form not in replaced:
        raise UsageError(f"{path} has no form \"{form}\"")
    settings = {**full, **replaced.get(form, {})}
    for change in changes:
        place, equals, value = change.partition("=")
        *parents, last = place.split(".")
        inner = settings
        try:
            for parent in parents:
                inner = inner[int(parent)] if isinstance(inner, list) else inner[parent]
        except (LookupError, TypeError, ValueError):
            inner = None
        if not equals or not isinstance(inner, dict) or (inner is settings and last not in inner):
            known = ", ".join(settings)
            raise UsageError(f"--set={change}: not of the form NAME=VALUE with one of {known}")
        try:
            inner[last] = json.loads(value)
        except json.JSONDecodeError:
            inner[last] = value
    return settings


def _without_folders(settings):
    """Settings for others to read: of a path of this machine the name of the file."""
    return {name: pathlib.PurePath(value).name if isinstance(value, str) and value.startswith("/")
            else value for name, value in settings.items()}


def write_run(path, setting, store, units, build):
    """Writes what a run used, how much of it is there, and how long that took.

    The revision of a program is that of the sources when its units were made (null: of units from
    before that was recorded).
    """
    records = [record for unit in units if (record := store.record(unit))]
    machines = {json.dumps(record["machine"]): record["machine"] for record in records}
    failed = sum(not store.is_done(unit) and store.failure(unit) is not None for unit in units)
    programs = sorted({(pathlib.PurePath(record["command"][0]).name, record["program_sha256"],
                        record.get("revision")) for record in records}, key=str)
    run = {"experiment": setting.name,
           "form": setting.form,
           "settings": _without_folders(setting.manifest),
           "sources": [source.name for source in setting.sources],
           "units": {"all": len(units), "made": len(records), "failed": failed},
           "seconds": round(sum(record["seconds"] for record in records), 1),
           "first_finished": min((record["finished"] for record in records), default=None),
           "last_finished": max((record["finished"] for record in records), default=None),
           "machines": list(machines.values()),
           "programs": [{"name": name, "sha256": sha256, "revision": revision}
                        for name, sha256, revision in programs],
           "tabulated_at": machine.revision(),
           "versions": machine.versions(build),
           "date": datetime.date.today().isoformat()}
    path.write_text(_text(run))
