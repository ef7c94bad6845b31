# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests with the bpy module. Each file of them runs in a process of its own.

What one test does to Blender's data and add-ons would stay for all that follow, and a crash of Blender would end them
all. So the pytest that the user started runs a second one for each file, and takes its reports over; the tests
themselves are written like any others.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

REPORTS = "LAMBENT_TEST_REPORTS"  # inside: the file that reports go to
TIMEOUT_S = 900
_reports = {}  # file of tests: {node id: [report, ...]}


@pytest.fixture
def registered():
    """The add-on is there during the test."""
    import addon

    addon.register()
    yield
    addon.unregister()


@pytest.fixture
def scene(registered):
    """A small scene whose engine is Lambent; see small_blend."""
    from blender_tests.helpers.small_blend import small_scene

    return small_scene()


# ---- A process for each file -----------------------------------------------------------------------------------------


def pytest_runtest_protocol(item, nextitem):
    if REPORTS in os.environ or Path(__file__).parent not in item.path.parents:
        return None
    if item.path not in _reports:
        _reports[item.path] = run_file(item)
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in _reports[item.path][item.nodeid]:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def run_file(item):
    """Run the chosen tests of one file in a fresh process. Returns their reports."""
    chosen = [other.nodeid for other in item.session.items if other.path == item.path]
    pipe = Path(item.config._tmp_path_factory.mktemp("reports")) / "reports.jsonl"
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--no-header", "--no-summary", *chosen],
        cwd=item.config.rootpath,
        env={**os.environ, REPORTS: str(pipe)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
    )
    reports = {nodeid: [] for nodeid in chosen}
    for line in pipe.read_text().splitlines() if pipe.exists() else ():
        report = item.config.hook.pytest_report_from_serializable(config=item.config, data=json.loads(line))
        if report.skipped:
            report.longrepr = tuple(report.longrepr)  # file, line and reason; JSON knows no tuples
        reports[report.nodeid].append(report)
    for nodeid, found in reports.items():
        if not any(report.when == "teardown" for report in found):
            message = f"Blender ended with exit code {run.returncode} in or before this test.\n{run.stdout[-4000:]}"
            found.append(pytest.TestReport(nodeid, item.location, {}, "failed", message, "call"))
    return reports


def pytest_runtest_logreport(report):
    if REPORTS in os.environ:
        from _pytest.reports import pytest_report_to_serializable

        with open(os.environ[REPORTS], "a") as pipe:
            pipe.write(json.dumps(pytest_report_to_serializable(report)) + "\n")


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    if REPORTS in os.environ:
        sys.stdout.flush()
        os._exit(0)  # bpy 4.5.15 hangs when it is unloaded: OpenVDB waits for a thread of its own
