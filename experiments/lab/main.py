"""The command `trilobe-experiments`."""
import argparse
import collections
import json
import os
import pathlib
import shutil
import signal
import sys

from lab import UsageError, campaign, experiments, fits, manifest, materials, records, tables
from lab.experiments import Result, Setting
from lab.units import Store

EPILOGUE = """
NAME     run an experiment: what is in the folder --out already is kept
list     the experiments and their questions
all      all of them, one after the other, and their anisotropic forms, as far as they take what is given
records  lower the book of records (experiments/records) by the fits in OUT and in folders of fits, as trilobe study
         leaves them; with --search and BRDF files, look for lower ones
report   all pages with their tables and pictures in one file, OUT/report.html
"""


SOME_FAILED = 3  # exit status: everything was tried, and some units have failed
PUBLISHED_ROWS = 1000  # limit for tables: a larger one is bulk, which stays in OUT


def _threads(text):
    numbers = text.split(",")
    if not all(number.isdigit() and int(number) > 0 for number in numbers):
        raise argparse.ArgumentTypeError(f"'{text}': give numbers of threads, 1,2")
    return [int(number) for number in numbers]


def parse(arguments):
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="trilobe-experiments", description="Runs the experiments (experiments/README.md).",
        epilog=EPILOGUE, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", metavar="NAME|list|all|records|report")
    parser.add_argument("sources", nargs="*", metavar="SOURCE",
                        help="BRDF files, folders of them, synth:NAME; default: the manifest's")
    parser.add_argument("--quick", action="store_const", const="quick", dest="form", default="full",
                        help="the form of a few seconds")
    parser.add_argument("--anisotropic", action="store_const", const="anisotropic", dest="form",
                        help="the form of anisotropic materials, where an experiment has one")
    parser.add_argument("--out", type=pathlib.Path, help="default: out/experiments, with --quick "
                        "out/experiments-quick")
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"),
                        help="build folder (%(default)s)")
    parser.add_argument("--program", type=pathlib.Path, help="default: BUILD/bin/trilobe")
    parser.add_argument("--solvers", help="comma-separated: these of the manifest's, and "
                        "others that the program has, in the runs that compare solvers")
    parser.add_argument("--threads", type=_threads, metavar="N,...",
                        help="instead of the manifest's")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        help="another value in the manifest, --set=flags.max_seconds=5")
    parser.add_argument("--shard", metavar="i/n", help="make only the i-th of n parts, i from 1; "
                        "tables come when all are there")
    parser.add_argument("--again", action="store_true", help="make units anew that are there")
    parser.add_argument("--count", action="store_true",
                        help="only print how many units are to make")
    parser.add_argument("--no-run", action="store_true",
                        help="make nothing; tables and pictures of what is there")
    parser.add_argument("--search", action="store_true", help="records: by multistart, each record of the BRDF files "
                        "that has not been searched; with --again all")
    parser.add_argument("--draw", action="store_true", help="only draw, from the tables in OUT")
    parser.add_argument("--publish", action="store_true",
                        help="copy pictures, and tables of at most "
                        f"{PUBLISHED_ROWS} rows, into experiments/NAME/results")
    options = parser.parse_intermixed_args(arguments)
    if options.out is None:
        options.out = pathlib.Path("out/experiments-quick" if options.form == "quick"
                                   else "out/experiments")
    return options


def shard(text):
    """(i, n) of "i/n"."""
    i, slash, n = text.partition("/")
    if not (slash and i.isdigit() and n.isdigit() and 1 <= int(i) <= int(n)):
        raise UsageError(f"--shard={text}: give i/n with 1 <= i <= n")
    return int(i), int(n)


def setting_of(experiment, options):
    """The setting that this command line asks for."""
    settings = experiment.settings(options.form, options.set)
    if "runs" not in settings and (options.solvers or options.threads):
        raise UsageError(f"{experiment.name} takes no --solvers and no --threads")
    runs = fits.checked(settings.get("runs", []))
    known = {name for of in runs for name in of["solvers"]}
    compared = any(len(of["solvers"]) > 1 for of in runs)
    for of in runs:
        if options.threads:
            of["threads"] = options.threads
        if options.solvers:
            joined = len(of["solvers"]) > 1 or not compared  # by solvers that no run names
            of["solvers"] = [name for name in options.solvers.split(",")
                             if name in of["solvers"] or (joined and name not in known)]
    places = options.sources or settings.get("sources", [])
    if not places and settings.get("needs_sources", True):
        raise UsageError("give BRDF files or folders of them, or --quick")
    return Setting(name=experiment.name, form=options.form, manifest=settings,
                   sources=materials.find([*places, *settings.get("also", [])]), build=options.build,
                   main_program=(options.program or options.build / "bin" / "trilobe").resolve())


def draw(experiment, folder):
    """Draws pictures and texts into the folder, from the tables there. One that is not there, as bulk ones are not
    in published results, is taken for empty, and what shows it is left as it is."""
    from lab import plots  # here: it takes a second to load
    of_name = collections.defaultdict(list, {path.stem: tables.read(path) for path in sorted(folder.glob("*.csv"))})
    if not of_name:
        raise UsageError(f"{folder} holds no tables; run the experiment first")
    for name, rows in of_name.items():
        if records.refresh(rows):
            tables.write(folder / f"{name}.csv", rows)
    for name, content in experiment.module.draw(of_name, folder).items():
        if isinstance(content, str):
            (folder / name).write_text(content)
        else:
            plots.save(content, folder / f"{name}.png")


def _fill(folder, fill):
    """Lets `fill` fill a new folder, which then takes the place of this one; all or nothing."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = folder.with_name(f".{folder.name}.part-{os.getpid()}")
    shutil.rmtree(part, ignore_errors=True)
    try:
        fill(part)
        shutil.rmtree(folder, ignore_errors=True)
        part.rename(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def tabulate(experiment, setting, store, units, folder):
    """Writes the tables of what is there."""
    results = [Result(unit, store.folder(unit) if store.is_done(unit) else None) for unit in units]
    folder.mkdir()
    for name, content in experiment.module.tabulate(setting, results).items():
        if isinstance(content, bytes):
            (folder / name).write_bytes(content)
        else:
            tables.write(folder / f"{name}.csv", content)
    manifest.write_run(folder / "manifest.json", setting, store, campaign.distinct(units),
                       setting.build)


def bulk(folder):
    """The tables of a folder that are not published: of more than PUBLISHED_ROWS rows."""
    return [path for path in sorted(folder.glob("*.csv"))
            if len(tables.read(path)) > PUBLISHED_ROWS]


def publish(experiment, folder, form="full"):
    """Copies a run's pictures and small tables to where the page looks for them."""
    units = json.loads((folder / "manifest.json").read_text())["units"]
    if left := units["all"] - units["made"] - units["failed"]:
        raise UsageError(f"{left} units have not been tried yet; publish when they are")
    kept = bulk(folder)
    published = experiment.published(form)
    _fill(published, lambda part: shutil.copytree(
        folder, part, ignore=shutil.ignore_patterns(*(path.name for path in kept))))
    for path in kept:
        print(f"not copied, more than {PUBLISHED_ROWS} rows: {path}")
    size = sum(path.stat().st_size for path in published.rglob("*") if path.is_file())
    print(f"copied to {published}: {size / 1e6:.2f} MB")


def _units(experiment, setting):
    """The units of a manifest that may hold anything."""
    try:
        return experiment.module.units(setting)
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        raise UsageError(f"the settings of {experiment.name} are not what it takes "
                         f"({type(error).__name__}: {error}); compare with "
                         f"{experiment.folder / 'manifest.json'}") from error


def _one_each(experiment, units):
    """Refuses fits by several of what the experiment's tables do not tell apart."""
    for label in getattr(experiment.module, "ONE", ()):
        given = sorted({str(unit.labels[label]) for unit in units if label in unit.labels})
        if len(given) > 1:
            raise UsageError(f"{experiment.name} takes one of \"{label}\" at a time, not "
                             f"{', '.join(given)}")


def of_form(name, form):
    """The folder in OUT of a form's tables: the anisotropic one's is beside the full one's."""
    return f"{name}-anisotropic" if form == "anisotropic" else name


def run(experiment, options):
    """Runs one experiment; returns the exit status."""
    folder = options.out / of_form(experiment.name, options.form)
    if options.publish and options.form == "quick":
        raise UsageError("the page shows no quick form; publish without --quick")
    failures = []
    if options.draw:
        if not folder.is_dir():
            raise UsageError(f"{folder} holds no tables; run the experiment first")

        def redraw(part):
            shutil.copytree(folder, part)
            draw(experiment, part)
        _fill(folder, redraw)
    else:
        setting = setting_of(experiment, options)
        store = Store(options.out / "units")
        units = _units(experiment, setting)
        if not units:
            raise UsageError(f"none of the {len(setting.sources)} materials given is among those "
                             "that the manifest takes of the lists (\"every\"); "
                             "--set=runs.0.every=1 takes all")
        _one_each(experiment, units)
        part = units
        if options.shard:
            part = campaign.shard_of(units, *shard(options.shard))
        if options.count:
            print(sum(not store.is_done(unit) for unit in campaign.distinct(part)))
            return 0
        failures = [] if options.no_run else campaign.run(store, part, options.again)
        if failures:
            print("\n  ".join([f"missing: {len(failures)} units; the same command tries them again",
                              *failures]), file=sys.stderr)
        if options.shard:
            print("run it without --shard for tables and pictures, when all shards are made",
                  file=sys.stderr)
            return SOME_FAILED if failures else 0

        def fill(part):
            tabulate(experiment, setting, store, units, part)
            draw(experiment, part)
        _fill(folder, fill)
        if options.form != "quick":  # tells results below the book's
            try:
                lines = records.update(setting.main_program, store.root, new=False)[1:]
            except UsageError as error:
                lines = [f"the book of records stays as it was: {error}"]
            for line in lines:
                print(line)
    print(f"wrote {folder}")
    if options.publish:
        publish(experiment, folder, options.form)
    return SOME_FAILED if failures else 0


def list_experiments():
    """A line or two for each."""
    for name in experiments.names():
        print(f"{name}\n    {experiments.settings(name)['question']}")


def _same_run(folder, other):
    """Whether both folders have the tables of one run."""
    records = [path / "manifest.json" for path in (folder, other)]
    return all(path.is_file() for path in records) and records[0].read_bytes() == records[1].read_bytes()


def write_report(options):
    """Takes what was run last into --out, or else what is published."""
    from lab import report

    def results_of(experiment, form="full"):
        here, published = options.out / of_form(experiment.name, form), experiment.published(form)
        if here.is_dir() and not _same_run(here, published):
            return report.Results(here, published=False)
        return report.Results(published if published.is_dir() else None)
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "report.html"
    everything = [experiments.load(name) for name in experiments.names()]
    report.write(path, report.in_order(everything, experiments.FOLDER / "README.md"), results_of)
    print(f"wrote {path}")


def run_all(options):
    """Runs every experiment, in the order of their index, in its full and its anisotropic form; or in the quick
    form. An experiment gets the sources if it has none of its own, and the settings whose names it knows. Returns the
    worst exit status."""
    from lab import report
    of_all = report.in_order([experiments.load(name) for name in experiments.names()],
                             experiments.FOLDER / "README.md")
    given = {change.partition("=")[0].partition(".")[0] for change in options.set}
    known = {name for experiment in of_all for name in experiment.settings()}
    if unknown := sorted(given - known):
        raise UsageError(f"--set={unknown[0]}: no experiment has a setting of this name")
    worst = 0
    for experiment in of_all:
        for form in (["quick"] if options.form == "quick" else experiment.forms()):
            settings = experiment.settings(form)
            own = dict(vars(options), name=experiment.name, form=form,
                       set=[change for change in options.set if change.partition("=")[0].partition(".")[0] in settings])
            if "sources" in settings or not settings.get("needs_sources", True):
                own["sources"] = []
            print(f"== {of_form(experiment.name, form)}", flush=True)
            worst = max(worst, run(experiment, argparse.Namespace(**own)))
    return worst


def update_records(options):
    """Lowers the book of records by what is in --out, in the folders of fits given, and by a search of the BRDF files
    given. Returns the exit status."""
    program = (options.program or options.build / "bin" / "trilobe").resolve()
    fitted = [place for place in options.sources if next(pathlib.Path(place).rglob("report.json"), None)]
    places = [place for place in options.sources if place not in fitted]
    if places and not options.search:
        raise UsageError(f"{places[0]} holds no fits; --search searches the records of BRDF files")
    if options.search and not places:
        raise UsageError("--search: give BRDF files or folders of them")
    failures = []
    if options.search:
        failures = records.search(program, Store(options.out / "units"), materials.find(places), again=options.again)
        print("\n".join(failures), file=sys.stderr)
    for folder in [options.out / "units", *map(pathlib.Path, fitted)]:
        print("\n".join(records.update(program, folder)))
    return SOME_FAILED if failures else 0


def stop(signal_number, _):
    """Ends the run like Ctrl-C: the unit that is being made is dropped, all others stay."""
    raise KeyboardInterrupt(signal_number)


def main(arguments=None):
    """Returns the exit status."""
    options = parse(arguments)
    signal.signal(signal.SIGTERM, stop)
    try:
        if options.name == "list":
            list_experiments()
        elif options.name == "report":
            write_report(options)
        elif options.name == "all":
            return run_all(options)
        elif options.name == "records":
            return update_records(options)
        else:
            return run(experiments.load(options.name), options)
        return 0
    except (UsageError, OSError) as error:
        print(f"trilobe-experiments: error: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        print(f"trilobe-experiments: error: this Python has no {error.name}; Debian's has it with the packages "
              "of the group check in dependencies.txt, which ./check installs", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\nstopped; the same command goes on from here", file=sys.stderr)
        return 130
