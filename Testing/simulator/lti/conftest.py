"""The tool in its own event loop, a platform that is registered there, and a study."""

from __future__ import annotations

import json

import pytest

from rastrainer.study.database.study import Study
from rastrainer_simulator.lti.lti_server import LtiServer
from rastrainer_simulator.lti.platform_client import PlatformClient
from rastrainer_simulator.lti.settings import KEY_FILE, SETTINGS_FILE, ToolKey, read_lti_settings
from Testing.simulator.lti.platform_double import Browser, PlatformDouble
from Testing.simulator.net.igtl.servers import HOST, PATIENCE_S

ADDRESS = "https://rastrainer.example.org"


class ServedTool:
    """A server of ours with a study.

    Attributes:
        url: where it listens.
        study: path of the study.
        server: it.
    """

    def __init__(self, thread, study, config, port, timeout_s):
        self.thread, self.study = thread, study
        self._client = thread.run(PlatformClient(timeout_s).__aenter__())
        self.server = thread.call(
            LtiServer, study, read_lti_settings(config), ToolKey(config), self._client
        )
        self.url = f"http://{HOST}:{thread.run(self.server.listen(HOST, port))}"

    def send_due(self) -> int:
        return self.thread.run(self.server.grades.send_due())

    def close(self):
        self.thread.run(self.server.close())
        self.thread.run(self._client.__aexit__())


class Lab:
    """A platform, and the tool with settings, key and a study.

    Attributes:
        platform: it.
        config: the tool's folder of settings.
        study: path of the study.
        tool: the tool that was started last.
        address: by which browsers reach it; with a `port`, they really do.
    """

    def __init__(self, thread, folder, key_file, study, port=0):
        self.thread, self.study = thread, folder / "study.db"
        self._port, self.address = port, f"http://{HOST}:{port}" if port else ADDRESS
        self.study.write_bytes(study)
        self.platform = PlatformDouble(thread)
        self.config = folder / "config"
        self.config.mkdir()
        (self.config / KEY_FILE).write_bytes(key_file)
        (self.config / KEY_FILE).chmod(0o600)
        self.set()
        self._started: list[ServedTool] = []
        self.start()

    def set(self, **changes):
        """Write the settings, with changes of what they say of the platform."""
        settings = {"address": self.address, "platforms": [self.platform.settings(**changes)]}
        (self.config / SETTINGS_FILE).write_text(json.dumps(settings))

    def start(self, timeout_s: float = PATIENCE_S) -> ServedTool:
        """Start the tool, as after a crash of the previous one."""
        self.tool = ServedTool(self.thread, self.study, self.config, self._port, timeout_s)
        self.platform.tool = self.tool.url
        self._started.append(self.tool)
        return self.tool

    def new_browser(self) -> Browser:
        return Browser(self.thread, self.tool.url, self.platform, f"{self.address}/launch")

    def trainees(self) -> list[str]:
        with Study.open_for_reading(self.study) as study:
            return [trainee.pseudonym for trainee in study.trainees()]

    def close(self):
        for tool in self._started:
            tool.close()
        self.platform.close()


@pytest.fixture(scope="session")
def key_and_study(tmp_path_factory):
    """A key and a study without trainees, made once since that takes time."""
    folder = tmp_path_factory.mktemp("lti")
    ToolKey(folder)
    Study.open(folder / "study.db").close()
    return (folder / KEY_FILE).read_bytes(), (folder / "study.db").read_bytes()


@pytest.fixture(scope="module")
def lab(loop_thread, tmp_path_factory, key_and_study):
    """A lab for all tests of a file."""
    lab = Lab(loop_thread, tmp_path_factory.mktemp("lab"), *key_and_study)
    yield lab
    lab.close()


@pytest.fixture
def platform(lab) -> PlatformDouble:
    return lab.platform


@pytest.fixture
def browser(lab) -> Browser:
    return lab.new_browser()
