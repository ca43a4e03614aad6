#!/usr/bin/env python3
"""Checks how many files each addition of "What to touch" in docs/architecture.md touches.

Adds a made-up subcommand, format, form of the model, solver and weighting to a copy of the working tree by the
files that the page names, counts them against its numbers, and compiles what was touched; with --build the whole
program, and runs it. Counts the files that name each real subcommand, format and a real form, too.
scripts/check_what_to_touch.py [--build]
"""
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Copy:
    """A copy of the tracked files, and which of them an addition touches."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
        for name in filter(None, files.decode().split("\0")):
            if (ROOT / name).is_file() and not re.match("experiments/.*/results", name):
                (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(ROOT / name, self.folder / name)
        self.touched = set()

    def add(self, path, text):
        (self.folder / path).write_text(text)
        self.touched.add(path)

    def after(self, path, pattern, text):
        """Puts `text` after the first place of `path` that matches."""
        content = (self.folder / path).read_text()
        found = re.search(pattern, content)
        if not found:
            sys.exit(f"{path} has no {pattern!r} any more; mend scripts/check_what_to_touch.py")
        self.add(path, content[:found.end()] + text + content[found.end():])


def subcommand(tree):
    tree.add("src/app/made_up_command.cc", """#include "app/command.h"

namespace trilobe {

Command MadeUpCommand() {
  return {.name = "made_up",
          .summary = "does nothing",
          .arguments = "",
          .details = "Nothing.",
          .flags = {},
          .run = [](std::span<const std::string>) { return 0; }};
}

}  // namespace trilobe
""")
    tree.after("src/app/command.h", r"Command InfoCommand\(\);\n", "Command MadeUpCommand();\n")
    tree.after("src/app/main.cc", r"InfoCommand\(\),", " MadeUpCommand(),")


def solver(tree):
    tree.add("src/solvers/made_up.cc", """#include <memory>

#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

class MadeUp : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("made_up", objective, options, model);
    run.Start();
    return run.Finish();
  }
};

}  // namespace

SolverEntry MadeUpEntry() {
  return {.name = "made_up",
          .description = "leaves the model as it is",
          .reference = "none",
          .options = {},
          .make = [] { return std::make_unique<MadeUp>(); }};
}

}  // namespace trilobe
""")
    tree.after("src/solvers/starts/solvers.cc", r"X\(LmPlain\)", " \\\n  X(MadeUp)")


def measurement_format(tree):
    tree.add("src/io/formats/databases/made_up_file.cc", """#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

MeasurementFormat MadeUpFormat() {
  return {.name = "made_up",
          .description = "a made-up file",
          .ending = ".made_up",
          .recognise = [](std::string_view bytes) { return bytes.starts_with("made up"); },
          .read = [](std::string_view, const std::string& source, const SourceOptions&) -> Measurement {
            throw ErrorIn(ErrorKind::kData, source, "nothing is in it");
          }};
}

}  // namespace trilobe
""")
    tree.after("src/io/formats/source.cc", r"X\(Merl\) *\\\n", "  X(MadeUp) \\\n")


def form(tree):
    tree.after("include/trilobe/model/model_spec.h", r"static ModelSpec IndependentG\([^;]*;\n",
               "  static ModelSpec MadeUp(const MerlGrid& grid);\n")
    tree.after("src/model/model_spec.cc", r"\nnamespace trilobe \{\n", """
ModelSpec ModelSpec::MadeUp(const MerlGrid& grid) {
  ModelSpec spec = SharedFactors(2, grid);
  spec.G.per_lobe = false;
  return spec;
}
""")
    tree.after("include/trilobe/fit/form.h", r"kIndependent,[^\n]*\n", "    kMadeUp,\n")
    tree.after("src/fit/form.cc", r"ModelSpec spec = (?=independent)",
               "options.kind == Kind::kMadeUp ? ModelSpec::MadeUp(grid) : ")
    tree.after("src/fit/form.cc", r'\{"independent", Kind::kIndependent,[^}]*\},', '\n{"made_up", Kind::kMadeUp, "two lobes"},')


def weighting(tree):
    tree.after("src/model/objective/weighting.cc", r'\{"uniform", "1", true, ByChannel\(UniformWeight\)\},',
               '\n      {"made_up", "1, too", true, ByChannel(UniformWeight)},')


def option(tree):
    """An option that halves all values: its member, its row, its meaning, its keyword in Python."""
    tree.after("include/trilobe/io/formats/measurement_format.h", r"double cosine_o = 0;[^\n]*\n",
               "  bool made_up = false;  // halves all values\n")
    tree.after("src/io/formats/source_option.cc", r"using Options = SourceOptions;\n  return \{\n", """
      Option<"made_up", &Options::made_up>({.help = "halve all values", .changes_values = true}),
""")
    tree.after("src/io/formats/source.cc", r'apply\("cosine_o", -options\.cosine_o\);\n', '  apply("scale", options.made_up ? 0.5 : 1);\n')
    tree.after("python/trilobe/_fitting/measurement.py", r"    scale: float = 0,\n", "    made_up: bool = False,\n")
    tree.after("python/trilobe/_fitting/measurement.py", r"        scale=scale,\n", "        made_up=made_up,\n")


def fit_option(tree):
    """An option that leaves the comparison of a fit out: its member, its row, its meaning, its keyword in Python."""
    tree.after("include/trilobe/fit/fit_options.h", r"bool raw = false;\n", "  bool made_up = false;  // compares nothing\n")
    tree.after("src/fit/fit_option.cc", r"using Options = FitOptions;\n  return \{\n", """
      Option<"made_up", &Options::made_up>({.help = "compare nothing", .changes_model = false}),
""")
    tree.after("src/fit/fit.cc", r"if \(options_\.compare(?=\))", " && !options_.made_up")
    tree.after("python/trilobe/_fitting/fit.py", r"    raw: bool = False,\n", "    made_up: bool = False,\n")
    tree.after("python/trilobe/_fitting/fit.py", r'        "raw": raw,\n', '        "made_up": made_up,\n')


ADDITIONS = {"a subcommand": subcommand, "an option of a measurement": option, "an option of a fit": fit_option, "a solver": solver, "a format of measurements": measurement_format,
             "a form of the model": form, "a weighting": weighting}


def numbers_of_the_page():
    page = (ROOT / "docs/architecture.md").read_text()
    return {row[1].split(":")[0]: int(row[2]) for row in re.finditer(r"^\| (an? [^|]*) \| (\d+) \|", page, re.M)}


def files_naming(pattern):
    """The files of src and include in which the pattern is found."""
    return {path.relative_to(ROOT).as_posix() for folder in ("src", "include") for path in (ROOT / folder).rglob("*")
            if path.suffix in (".h", ".cc") and re.search(pattern, path.read_text(), re.M)}


def check_real_commands(wanted):
    for command in re.findall(r"^Command (\w+)\(\);", (ROOT / "src/app/command.h").read_text(), re.M):
        check_real(command, files_naming(rf"\b{command}\b"), wanted)


def check_real_form(wanted):
    check_real("--model=independent", files_naming(r'\b(IndependentG|kIndependent)\b|"independent"'), wanted)


def check_real(name, files, wanted):
    if len(files) != wanted:
        sys.exit(f"docs/architecture.md says {wanted} files, and {name} is named by {', '.join(sorted(files))}")


def check_real_formats(wanted):
    """A format whose reader has no header, as nothing else calls it, is named by its own file and its line."""
    registry = "src/io/formats/source.cc"
    names = re.findall(r"^  X\((\w+)\)", (ROOT / registry).read_text(), re.M)
    counted = [name for name in names if not [*(ROOT / "src/io/formats").rglob(f"{name.lower()}_file.h")]]
    if len(counted) < 4:
        sys.exit(f"{registry} lists {names}, of which no more than {counted} can be counted")
    for name in counted:
        naming = files_naming(rf"\b{name}Format\b|^  X\({name}\)")
        print(f"{name}: {len(naming)} files")
        if len(naming) != wanted or registry not in naming:
            sys.exit(f"docs/architecture.md says {wanted} files for a format, and {name} is in {sorted(naming)}")


def compile_touched(tree):
    """Checks the touched files without generating code, as the tidy preset compiles their sources."""
    build = tree.folder / "build/tidy"
    subprocess.run(["cmake", "--preset", "tidy", "-B", build], cwd=tree.folder, check=True, stdout=subprocess.DEVNULL)
    commands = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    for path in sorted(tree.touched):
        source = tree.folder / re.sub(r"^include/trilobe/(.*)\.h$", r"src/\1.cc", path)
        if str(source) not in commands:
            continue
        words = shlex.split(commands[str(source)]["command"])
        output = words.index("-o")
        subprocess.run(words[:output] + words[output + 2:] + ["-fsyntax-only"], cwd=build, check=True)


def main():
    wanted = numbers_of_the_page()
    check_real_commands(wanted["a subcommand"])
    check_real_form(wanted["a form of the model"])
    with tempfile.TemporaryDirectory() as folder:
        tree = Copy(folder)
        everything = set()
        for name, add in ADDITIONS.items():
            tree.touched = set()
            add(tree)
            everything |= tree.touched
            count = len(tree.touched)
            print(f"{name}: {count} files")
            if count != wanted.get(name):
                sys.exit(f"docs/architecture.md says {wanted.get(name)} files for {name}, and it takes {count}")
        check_real_formats(wanted["a format of measurements"])
        tree.touched = everything
        subprocess.run(["cmake", f"-Droot={folder}", "-P", "cmake/TrilobeCheckRooms.cmake"], cwd=folder, check=True)
        compile_touched(tree)
        if "--build" in sys.argv[1:]:
            build = tree.folder / "build/release"
            subprocess.run(["cmake", "--preset", "release", "-B", build, "-DTRILOBE_BUILD_TESTS=OFF"],
                           cwd=folder, check=True, stdout=subprocess.DEVNULL)
            subprocess.run(["ninja", "-C", build, "trilobe_app"], check=True, stdout=subprocess.DEVNULL)
            program = build / "bin/trilobe"
            subprocess.run([program, "made_up"], check=True)
            subprocess.run([program, "info", "synth:rubber@20x20x40", "--made_up"], check=True, stdout=subprocess.DEVNULL)
            subprocess.run([program, "fit", "synth:rubber@20x20x40", "--solver=made_up", "--model=made_up",
                            "--weighting=made_up"], check=True, stdout=subprocess.DEVNULL)
    print("each takes what docs/architecture.md says, and compiles")


if __name__ == "__main__":
    main()
