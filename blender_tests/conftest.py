# SPDX-License-Identifier: GPL-3.0-or-later
"""What all levels of the tests share."""

import os
import sys
import traceback

import pytest

from tools import extension


@pytest.fixture(scope="session")
def installed_blender():
    """The command of an installed Blender, as a list; LAMBENT_BLENDER names it."""
    command = os.environ.get("LAMBENT_BLENDER")
    if not command:
        pytest.skip("needs an installed Blender: build.py test --blender COMMAND, or LAMBENT_BLENDER=COMMAND")
    return extension.split_command(command)


@pytest.fixture(scope="session")
def lambent_in_blender(installed_blender):
    """(command, environment variables) of an installed Blender that has Lambent's extension, as a user installs it."""
    return installed_blender, {**os.environ, **extension.install_into(installed_blender)}


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_sessionfinish(session):
    """Note how it ended, the summary included, for `pytest_unconfigure`."""
    try:
        result = yield
    except BaseException:
        traceback.print_exc()  # pytest would only do so after pytest_unconfigure
        session.config.lambent_exit_status = pytest.ExitCode.INTERNAL_ERROR
        raise
    session.config.lambent_exit_status = session.exitstatus
    return result


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """End at once where Blender is loaded: bpy 4.5 waits for a thread of its own for ever when it is unloaded."""
    if "bpy" in sys.modules and hasattr(config, "lambent_exit_status"):
        config.pluginmanager.get_plugin("terminalreporter").flush()  # it has a stream of its own
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(int(config.lambent_exit_status))
