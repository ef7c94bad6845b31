# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension package: a zip of the add-on with the engine inside, its manifest, and the wheels that it needs.

A wheel is made for one version of Python and one platform; Blender installs the fitting ones and leaves the others.
"""

import hashlib
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import zipfile

from .environment import (
    BUILD,
    FOLDER_OF_BLENDER,
    REQUIREMENTS,
    ROOT,
    UserError,
    environment,
    locked,
    python_in,
    runs,
    say,
)

# Blender's name of a platform -> the tags of its wheels, for pip
PLATFORMS = {
    "linux-x64": ["manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux2014_x86_64"],
    "windows-x64": ["win_amd64"],
    "macos-arm64": ["macosx_14_0_arm64"],
}
PYTHONS = ["3.11", "3.13"]  # of Blender 4.5 LTS and 5.2 LTS as they come from blender.org
PACKAGES = ["numba", "llvmlite"]  # numpy is part of Blender
WHEELS = BUILD / "wheels"


def this_platform():
    system = {"Linux": "linux", "Windows": "windows", "Darwin": "macos"}.get(platform.system(), "unknown")
    machine = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64"}.get(platform.machine().lower(), platform.machine())
    return f"{system}-{machine}"


def make_package(target, pythons, folder):
    """Write lambent-VERSION-TARGET.zip for these versions of Python into `folder`; returns its path."""
    if target not in PLATFORMS:
        raise UserError(f"there are no wheels of numba for {target}; there are for {', '.join(PLATFORMS)}")
    wheels = [wheel for python in pythons for wheel in fetch_wheels(target, python)]
    path = folder / f"lambent-{version()}-{target}.zip"
    unfinished = path.with_suffix(".part")
    folder.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("blender_manifest.toml", manifest(target, wheels))
        package.write(ROOT / "LICENSE", "LICENSE")
        for name, source in sorted(sources().items()):
            package.write(source, name)
        for wheel in wheels:
            package.write(wheel, "wheels/" + wheel.name, zipfile.ZIP_STORED)  # a wheel is compressed already
    unfinished.replace(path)
    return path


def sources():
    """Name in the package -> file: the add-on at its root, the engine as its sub-package."""
    files = {}
    for prefix, folder in (("", ROOT / "addon"), ("engine_core/", ROOT / "engine_core")):
        for path in folder.rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts and path.name != "blender_manifest.toml":
                files[prefix + path.relative_to(folder).as_posix()] = path
    return files


def manifest(target, wheels):
    """The add-on's manifest with its platform and wheels, which have to stand before the first [table]."""
    lines = ["platforms = [" + f'"{target}"' + "]", "wheels = ["]
    lines += [f'    "./wheels/{wheel.name}",' for wheel in wheels]
    text = (ROOT / "addon" / "blender_manifest.toml").read_text(encoding="utf-8")
    head, table, rest = text.partition("\n[permissions]")
    return head + "\n" + "\n".join(lines) + "\n]\n" + table + rest


def version():
    text = (ROOT / "addon" / "blender_manifest.toml").read_text(encoding="utf-8")
    return re.search(r'^version = "(.+)"', text, re.MULTILINE).group(1)


# ---- Wheels ----------------------------------------------------------------------------------------------------------


def fetch_wheels(target, python):
    """Paths of the pinned wheels for a platform and a Python such as "3.13"; they are kept in build/wheels."""
    return [fetch_wheel(pin, target, python) for pin in pins()]


def pins():
    """["numba==...", "llvmlite==..."], as in requirements.txt."""
    text = REQUIREMENTS.read_text(encoding="utf-8")
    return [re.search(rf"^{name}==\S+", text, re.MULTILINE).group(0) for name in PACKAGES]


def fetch_wheel(pin, target, python):
    cp = "cp" + python.replace(".", "")
    folder = WHEELS / target
    pattern = pin.replace("==", "-") + f"-{cp}-{cp}-*.whl"
    if not list(folder.glob(pattern)):
        say(f"Fetching {pin} for Python {python}, {target}")
        command = [*pip(), "download", "--quiet", "--disable-pip-version-check", "--no-deps", "--only-binary", ":all:"]
        command += ["--python-version", python, "--implementation", "cp", "--abi", cp, "--dest", str(folder)]
        for tag in PLATFORMS[target]:
            command += ["--platform", tag]
        if subprocess.run([*command, pin]).returncode != 0:
            raise UserError(f"could not download {pin} for Python {python} on {target}: see the lines above.")
    return next(folder.glob(pattern))


def pip():
    """A pip, wherever there is one already; else that of the environment."""
    for python in [python_in(folder) for folder in FOLDER_OF_BLENDER.values()] + [sys.executable]:
        if runs(python, "import pip, ssl"):
            return [str(python), "-m", "pip"]
    return [str(environment()), "-m", "pip"]


# ---- Checking and installing -----------------------------------------------------------------------------------------


def validate(package):
    """Have Blender's own tool check the package; that of the bpy module, which is the same program."""
    python = environment()
    tool = next(python.parent.parent.glob("**/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    result = subprocess.run([str(python), str(tool), "validate", str(package)], capture_output=True, text=True)
    if result.returncode != 0:
        raise UserError(f"Blender refuses {package}:\n{result.stdout}{result.stderr}")


def split_command(text):
    """What a user calls Blender with: a path, with spaces or not, or a command with arguments. Returns a list."""
    return [text] if shutil.which(text) else shlex.split(text, posix=os.name != "nt")


def python_of(blender):
    """The version of the Python inside an installed Blender, as "3.14"."""
    code = "import sys; print('python of blender', *sys.version_info[:2], sep=':')"
    try:
        result = subprocess.run(
            [*blender, "-b", "--factory-startup", "--python-expr", code],
            capture_output=True,
            text=True,
            errors="replace",
        )
    except OSError as error:
        raise UserError(f"cannot start {' '.join(blender)}: {error.strerror}") from None
    found = re.search(r"python of blender:(\d+):(\d+)", result.stdout)
    if not found:
        raise UserError(f"{' '.join(blender)} does not behave like Blender:\n{(result.stdout + result.stderr)[-500:]}")
    return f"{found.group(1)}.{found.group(2)}"


def install_into(blender):
    """Install the package into a folder of its own under build/, so the user's Blender stays as it is.

    Returns the environment variables with which this Blender finds it. Does nothing when the same state is there.
    """
    python = python_of(blender)
    home = BUILD / f"blender-python-{python}"
    variables = {"BLENDER_USER_RESOURCES": str(home)}
    stamp = home / "lambent-stamp"
    digest = source_digest()
    with locked(BUILD / f"{home.name}.lock"):
        if not stamp.exists() or stamp.read_text() != digest:
            say(f"Packing Lambent for this Blender (Python {python}) and installing it into {home.relative_to(ROOT)}")
            package = make_package(this_platform(), [python], BUILD)
            install(blender, package, variables)
            package.unlink()
            stamp.write_text(digest)
    return variables


def install(blender, package, variables):
    """What the user does with Install from Disk, and enables the add-on."""
    command = [*blender, "--command", "extension", "install-file", "-r", "user_default", "-e", str(package)]
    result = subprocess.run(command, env={**os.environ, **variables}, capture_output=True, text=True, errors="replace")
    if result.returncode != 0:
        raise UserError(f"Blender could not install the extension:\n{result.stdout}{result.stderr}")


def source_digest():
    """A digest of all that goes into the package."""
    digest = hashlib.sha256(" ".join(pins()).encode())
    for name, path in sorted(sources().items()):
        digest.update(name.encode() + path.read_bytes())
    digest.update((ROOT / "addon" / "blender_manifest.toml").read_bytes())
    return digest.hexdigest()
