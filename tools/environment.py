# SPDX-License-Identifier: GPL-3.0-or-later
"""The environments: a virtual environment with Blender as a Python module (bpy), one for each supported LTS version.

A stamp in the folder holds a digest of the pins, so a second start does nothing; it is written last, so an
interrupted setup is simply taken up again.
"""

import contextlib
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"  # downloads, packages under way, Blender's own folders; safe to delete
REQUIREMENTS = ROOT / "requirements.txt"
PYTHON_OF_BLENDER = {"5.2": "3.13", "4.5": "3.11"}  # the first is the default
FOLDER_OF_BLENDER = {"5.2": ROOT / ".venv", "4.5": ROOT / ".venv-4.5"}


class UserError(Exception):
    """Something that the user can mend; its text says how. Shown without a traceback."""


def say(text):
    print(text, flush=True)


def environment(blender_version=None):
    """The Python of the environment for this version of Blender (default: the newest for which there is a Python)."""
    version = blender_version or default_version()
    folder = FOLDER_OF_BLENDER[version]
    if not is_ready(version):
        with locked(BUILD / f"setup-{version}.lock"):
            if not is_ready(version):  # else another build.py made it while this one waited
                make(version)
    return python_in(folder)


def default_version():
    """Blender 5.2, or 4.5 where only the Python of that one is at hand."""
    for version, python in PYTHON_OF_BLENDER.items():
        if is_ready(version) or find_python(python):
            return version
    return next(iter(PYTHON_OF_BLENDER))


def is_ready(version):
    folder = FOLDER_OF_BLENDER[version]
    with contextlib.suppress(OSError):
        return (folder / "lambent-stamp").read_text() == stamp(version) and runs(python_in(folder))
    return False


def stamp(version):
    """Changes with the pins, and with the Blender that they are for."""
    return f"{version} {hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()}\n"


def python_in(folder):
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def runs(python, code=""):
    """Whether this Python starts and can run `code`."""
    try:
        return subprocess.run([str(python), "-c", code], capture_output=True).returncode == 0
    except OSError:
        return False


# ---- Making an environment ---------------------------------------------------------------------------------------


def make(version):
    folder = FOLDER_OF_BLENDER[version]
    wanted = PYTHON_OF_BLENDER[version]
    say(f"Setting up {folder.name} with Blender {version} LTS as a Python module.")
    if not runs(python_in(folder), f"import pip, sys; sys.exit(sys.version_info[:2] != ({wanted.replace('.', ', ')}))"):
        base = find_python(wanted)
        if base is None:
            raise UserError(how_to_get_python(version))
        say(f"  1/3 a virtual environment from {base}")
        command = [base, "-m", "venv", "--clear", str(folder)]
        if subprocess.run(command).returncode != 0:
            raise UserError(f"could not make {folder}: see the lines above.")
    else:
        say("  1/3 the virtual environment is there")

    say("  2/3 the pinned packages of requirements.txt (about 550 MB the first time)")
    command = [str(python_in(folder)), "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
    if subprocess.run([*command, "--only-binary", ":all:", "-r", str(REQUIREMENTS)]).returncode != 0:
        raise UserError(
            f"pip could not install the packages: see the lines above. Start the same command again, it goes on from "
            f"here; if it fails in the same way, delete {folder} first.\n(bpy exists for Linux x86_64, Windows x64 and "
            "macOS arm64. Elsewhere, render with an installed Blender: build.py render FILE --blender COMMAND.)"
        )

    say("  3/3 does Blender load?")
    check_bpy(folder)
    (folder / "lambent-stamp").write_text(stamp(version))
    say(f"Ready: {folder.name}\n")


@contextlib.contextmanager
def locked(path):
    """Wait until no other build.py sets up the same folder. The system drops the lock when a process ends."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as file:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
        else:
            import fcntl

            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                say("Waiting for another build.py that sets up the same environment ...")
                fcntl.flock(file, fcntl.LOCK_EX)
        yield


# ---- A Python of the right version ---------------------------------------------------------------------------------


def find_python(version):
    """Path of a Python of this version that can make virtual environments, or None."""
    seen = set()
    for path in candidates(version):
        if path and path not in seen:
            seen.add(path)
            code = f"import sys, ssl, venv, ensurepip; sys.exit(sys.version_info[:2] != ({version.replace('.', ', ')}))"
            if runs(path, code):
                return path
    return None


def candidates(version):
    """Where Pythons live: this one, PATH, pyenv, uv, the Windows launcher, Homebrew and python.org."""
    yield getattr(sys, "_base_executable", sys.executable)  # not the virtual environment that may run this
    for name in (f"python{version}", "python3", "python"):
        yield shutil.which(name)
    home = Path.home()
    pyenv = Path(os.environ.get("PYENV_ROOT") or home / ".pyenv")
    patterns = [pyenv / f"versions/{version}*/bin/python", pyenv / f"pyenv-win/versions/{version}*/python.exe"]
    for uv in (os.environ.get("UV_PYTHON_INSTALL_DIR"), home / ".local/share/uv/python", uv_folder_on_windows()):
        if uv:
            patterns += [
                Path(uv) / f"cpython-{version}*/bin/python{version}",
                Path(uv) / f"cpython-{version}*/python.exe",
            ]
    patterns += [f"/opt/homebrew/bin/python{version}", f"/usr/local/bin/python{version}"]
    patterns += [f"/Library/Frameworks/Python.framework/Versions/{version}/bin/python{version}"]
    for pattern in patterns:
        yield from sorted(glob.glob(str(pattern)), key=natural_key, reverse=True)
    if os.name == "nt" and shutil.which("py"):
        found = subprocess.run(
            ["py", f"-{version}", "-c", "import sys; print(sys.executable)"], capture_output=True, text=True
        )
        yield found.stdout.strip()


def uv_folder_on_windows():
    return os.environ.get("APPDATA") and Path(os.environ["APPDATA"]) / "uv/python"


def natural_key(path):
    """Sorts 3.13.10 after 3.13.9."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path)]


def how_to_get_python(version):
    python = PYTHON_OF_BLENDER[version]
    lines = [f"Blender {version} LTS as a module needs Python {python}, and none was found that can make environments."]
    incomplete = shutil.which(f"python{python}")
    if incomplete and os.name != "nt":
        lines.append(f"{incomplete} is there but incomplete: sudo apt-get install python{python}-venv")
    if shutil.which("uv"):
        lines.append(f"Get it with: uv python install {python}")
    elif shutil.which("pyenv"):
        lines.append(f"Get it with: pyenv install {python}")
    else:
        lines.append(
            f"Get it from https://www.python.org/downloads, or with uv (https://docs.astral.sh/uv): "
            f"uv python install {python}"
        )
    return "\n".join(lines)


# ---- Libraries of the system -----------------------------------------------------------------------------------------


def check_bpy(folder):
    """Import bpy; when a library of the system is missing, name it and the package that brings it."""
    # Blender 4.5 as a module can hang when a process ends in the ordinary way, so it never does here
    code = "import bpy, os; os._exit(0)"
    result = subprocess.run([str(python_in(folder)), "-c", code], capture_output=True, text=True, errors="replace")
    if result.returncode == 0:
        return
    missing = missing_libraries(folder, result.stderr)
    if missing:
        packages = " ".join(debian_package(library) for library in missing)
        raise UserError(
            f"Blender cannot load: this system lacks {', '.join(missing)}.\n"
            f"On Debian and Ubuntu: sudo apt-get install -y {packages}\nThen start the same command again."
        )
    lines = result.stderr.strip().splitlines() or [f"exit code {result.returncode}"]
    raise UserError(f"Blender cannot load: {lines[-1]}")


def missing_libraries(folder, message):
    """Names such as libXrender.so.1: all that `ldd` finds missing, at least the one that the error names."""
    missing = re.findall(r"(lib[^\s:]+\.so[.\d]*): cannot open shared object file", message)
    for module in folder.glob("lib/python*/site-packages/bpy/__init__*.so"):
        with contextlib.suppress(OSError):
            listing = subprocess.run(["ldd", str(module)], capture_output=True, text=True).stdout
            missing += re.findall(r"(\S+) => not found", listing)
    return sorted(set(missing))


def debian_package(library):
    """Debian names a library's package by rule: libXrender.so.1 is in libxrender1, libX11.so.6 in libx11-6."""
    name, _, version = library.lower().partition(".so")
    version = version.lstrip(".").split(".")[0]
    return f"{name}-{version}" if name[-1].isdigit() and version else name + version
