# SPDX-License-Identifier: GPL-3.0-or-later
"""What all levels of the tests share."""

import os
import shlex
import shutil
import sys

import pytest

from tools import extension


@pytest.fixture(scope="session")
def installed_blender():
    """The command of an installed Blender, as a list; LAMBENT_BLENDER names it."""
    command = os.environ.get("LAMBENT_BLENDER")
    if not command:
        pytest.skip("needs an installed Blender: build.py test --blender COMMAND, or LAMBENT_BLENDER=COMMAND")
    return [command] if shutil.which(command) else shlex.split(command)


@pytest.fixture(scope="session")
def lambent_in_blender(installed_blender):
    """(command, environment variables) of an installed Blender that has Lambent's extension, as a user installs it."""
    return installed_blender, {**os.environ, **extension.install_into(installed_blender)}


def pytest_sessionfinish(session, exitstatus):
    session.config.lambent_exit_status = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """End at once where Blender is loaded: bpy 4.5 waits for a thread of its own for ever when it is unloaded."""
    if "bpy" in sys.modules and hasattr(config, "lambent_exit_status"):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.lambent_exit_status)
