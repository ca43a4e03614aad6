"""Materials: their names, where they are found, and fixed subsets of the databases' lists."""
import dataclasses
import pathlib

from lab import UsageError

# All that we have, whether a file is given or not: what a material is counted as must not depend on
# the files given. MERL's are the 40 for which there are smooth stand-ins (docs/materials.md).
MERL = sorted("""
    alum-bronze aluminium black-obsidian black-oxidized-steel blue-acrylic blue-metallic-paint
    blue-rubber brass cherry-235 chrome color-changing-paint1 dark-blue-paint delrin
    gold-metallic-paint gold-paint green-fabric green-latex hematite ipswich-pine-221
    maroon-plastic nickel nylon pearl-paint pickled-oak-260 pink-felt polyethylene
    polyurethane-foam pvc red-fabric red-metallic-paint red-phenolic red-specular-plastic
    silver-metallic-paint specular-black-phenolic teflon tungsten-carbide violet-acrylic
    white-diffuse-bball white-paint yellow-matte-plastic""".split())
RGL = sorted("""
    acrylic_felt_green acrylic_felt_pink acrylic_felt_white aurora_white cc_green_malachite
    cc_ibiza_sunset cc_nothern_aurora cg_sunflower chm_mint chm_orange cm_toxic_green
    colodur_azure_4e colodur_napoli_4f ilm_l3_37_matte ilm_solo_m_68 irid_flake_paint1_fine
    irid_flake_paint2 leaf_maple paper_white satin_purple vch_dragon_eye_red vch_golden_yellow
    vch_ultra_pink""".split())

# `auto` was developed on every second material of each list, and on these of the others.
LOOKED_AT = {"blue-metallic-paint", "chrome", "leaf_maple", "satin_purple", "tungsten-carbide"}

SUFFIXES = (".binary", "_rgb.bsdf")


@dataclasses.dataclass(frozen=True)
class Source:
    """A measurement as `trilobe` takes it, and the name of its material."""

    name: str
    path: str

    @property
    def database(self):
        return "MERL" if self.name in MERL else "RGL" if self.name in RGL else "own"

    @property
    def half(self):
        """developing, reporting, or empty for a material of neither list."""
        if self.name in LOOKED_AT:
            return "developing"
        for names in (MERL, RGL):
            if self.name in names:
                return ("developing", "reporting")[names.index(self.name) % 2]
        return ""


def name_of(path):
    """The name of a file without its ending; synth:plastic becomes synth-plastic."""
    name = pathlib.PurePath(path).name
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    return name.replace(":", "-")


def find(places):
    """The sources in files, folders and synth: names, by name. Raises UsageError for a bad one."""
    paths = []
    for place in places:
        path = pathlib.Path(place)
        if place.startswith("synth:"):
            paths.append(place)
        elif path.is_dir():
            found = [str(file) for file in path.iterdir() if file.name.endswith(SUFFIXES)]
            if not found:
                raise UsageError(f"{place} holds no file that ends in {' or '.join(SUFFIXES)}")
            paths += found
        elif path.exists():
            paths.append(place if "/" in place else f"./{place}")  # units know files by their "/"
        else:
            raise UsageError(f"{place} does not exist; give BRDF files, folders of them, or "
                             "synth:NAME")
    sources = sorted((Source(name_of(path), path) for path in dict.fromkeys(paths)),
                     key=lambda source: source.name)
    for before, after in zip(sources, sources[1:]):
        if before.name == after.name:
            raise UsageError(f"{before.path} and {after.path} are of one material; give one")
    return sources


def named(files, sources):
    """The sources of these files, in this order, which must be among those given; None stands for all."""
    if files is None:
        return sources
    given = {source.name: source for source in sources}
    missing = [file for file in files if name_of(file) not in given]
    if missing:
        raise UsageError(f"the scene's {', '.join(missing)} are not among the files given; give "
                         "their folders, or --set=materials=null for a scene of all files given")
    return [given[name_of(file)] for file in files]


def every(sources, n):
    """Every n-th name of each list, from the first; of other names every n-th of those given.

    An odd n takes materials of both halves. {"MERL": 3} takes every third of that list, and all of
    the others.
    """
    own = sorted(source.name for source in sources if source.database == "own")
    step = n if isinstance(n, dict) else dict.fromkeys(("MERL", "RGL", "own"), n)
    chosen = {name for database, names in (("MERL", MERL), ("RGL", RGL), ("own", own))
              for name in names[::step.get(database, 1)]}
    return [source for source in sources if source.name in chosen]
