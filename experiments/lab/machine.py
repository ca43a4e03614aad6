"""The machine that figures were measured on, and versions of the software."""
import functools
import os
import pathlib
import platform
import re
import subprocess

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def _first_line(*command):
    """The first line that a command prints, or None."""
    try:
        lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    return next(iter(lines.splitlines()), None)


def _line_of(path, pattern):
    try:
        found = re.search(pattern, pathlib.Path(path).read_text(), re.MULTILINE)
    except OSError:
        return None
    return found.group(1).strip() if found else None


@functools.cache
def describe():
    """Processor, cores that this process may use, memory and system."""
    kib = _line_of("/proc/meminfo", r"^MemTotal:\s*(\d+)")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {"cpu": _line_of("/proc/cpuinfo", r"^model name\s*:(.*)") or platform.processor(),
            "cores": cores,
            "memory_GiB": round(int(kib) / 2 ** 20, 1) if kib else None,
            "system": _line_of("/etc/os-release", r'^PRETTY_NAME="?([^"\n]*)') or platform.system()}


@functools.cache
def revision():
    """Git revision of these sources, with "-dirty" where they differ from it; None outside a repository."""
    return _first_line("git", "-C", str(REPOSITORY), "describe", "--always", "--dirty")


@functools.cache
def versions(build):
    """Versions of the compiler of a CMake build folder, and of the libraries linked."""
    cache = pathlib.Path(build) / "CMakeCache.txt"
    compiler = _line_of(cache, r"^CMAKE_CXX_COMPILER:\w+=(.*)")
    packages = {}
    for line in (REPOSITORY / "dependencies.txt").read_text().splitlines():
        words = line.split()
        if words and words[0] == "run":
            packages[words[1]] = _first_line("dpkg-query", "--show", "--showformat=${Version}",
                                             words[1])
    return {"compiler": compiler and _first_line(compiler, "--version"),
            "build_type": _line_of(cache, r"^CMAKE_BUILD_TYPE:\w+=(.*)"),
            "python": platform.python_version(),
            "packages": packages}
