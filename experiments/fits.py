"""What the scripts in this folder share: `trilobe fit` run once, never mixing results."""
import json
import pathlib
import subprocess


def material_name(source):
    """The name of a file without its ending, or that of a synthetic material as it is."""
    name = pathlib.Path(source).name
    for suffix in (".binary", "_rgb.bsdf"):
        name = name.removesuffix(suffix)
    return name


def is_done(command, folder, product):
    """Whether that very command has made the product, a file in the folder."""
    record = folder / "command.json"
    return (record.exists() and (folder / product).exists()
            and json.loads(record.read_text()) == command)


def fit_once(command, folder, product, again=False):
    """Runs the command, which writes into the folder, unless that very command has done so before.

    Returns the path of the product, a file in the folder. With `again`, the command runs anyway.
    """
    if again or not is_done(command, folder, product):
        record = folder / "command.json"
        record.unlink(missing_ok=True)  # a run that is cut short may leave files of two commands
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        record.write_text(json.dumps(command))
    return folder / product
