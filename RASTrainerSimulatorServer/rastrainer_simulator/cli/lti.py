"""`rastrainer lti STUDY`: launches from a learning platform, and grades returned to it."""

from __future__ import annotations

import argparse
import asyncio
import importlib.util
import ssl
from pathlib import Path
from typing import TYPE_CHECKING

from rastrainer.errors import InputError
from rastrainer.files.reading import failure_reason, printable_name
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand, announce, check_ports

if TYPE_CHECKING:
    from rastrainer_simulator.lti.settings import LtiSettings, ToolKey
    from rastrainer_simulator.net.limits import ViewLimits

DEFAULT_LTI_PORT = 18965


def run(arguments: argparse.Namespace) -> int:
    if importlib.util.find_spec("jwt") is None:
        raise InputError("This needs PyJWT: install it with pip install 'rastrainer[lti]'.")
    check_ports(arguments)
    from rastrainer_simulator.lti.settings import ToolKey, read_lti_settings
    from rastrainer_simulator.net.limits import read_limits
    from rastrainer_simulator.ops.system_paths import config_folder

    config = arguments.config or config_folder()
    settings = read_lti_settings(config)
    key = ToolKey(config)
    if arguments.show:
        _show(settings, key)
        return 0
    if arguments.study is None:
        raise InputError("Name the study whose trainees the learners become.")
    tls = _tls(arguments.certificate, config) if arguments.lan else None
    asyncio.run(_serve(arguments, settings, key, read_limits(config).views, tls))
    return 0


async def _serve(
    arguments: argparse.Namespace,
    settings: LtiSettings,
    key: ToolKey,
    limits: ViewLimits,
    tls: ssl.SSLContext | None,
) -> None:
    from rastrainer_simulator.lti.lti_server import LtiServer
    from rastrainer_simulator.lti.platform_client import PlatformClient
    from rastrainer_simulator.ops.processes import stop_on_signals

    stop = asyncio.Event()
    async with PlatformClient() as client:
        server = LtiServer(arguments.study, settings, key, client, limits)
        try:
            with stop_on_signals(stop):
                host = "0.0.0.0" if arguments.lan else DEFAULT_HOST
                port = await server.listen(host, arguments.port, tls)
                server.return_grades()
                names = ", ".join(each.name for each in settings.platforms) or "no platform yet"
                announce("LTI", f"listens on {host}:{port} as {settings.address}: {names}")
                await stop.wait()
        finally:
            await server.close()


def _show(settings: LtiSettings, key: ToolKey) -> None:
    from rastrainer_simulator.lti.settings import KEYS, LOGIN

    print(f"Login initiation URL:            {settings.address}{LOGIN}")
    print(f"Redirect and target link URL:    {settings.launch_url}")
    print(f"Public keys (JWKS) URL:          {settings.address}{KEYS}")
    print("Custom parameters of a link:     task=task-1 mode=desktop rule=best")
    print("Grades need the service:         Assignment and Grade Services, score")
    for platform in settings.platforms:
        print(f"Registered: {platform.name} ({platform.issuer}), client ID {platform.client_id}")
    print("Where the platform cannot reach the JWKS URL, it takes this public key:")
    print(key.public_pem, end="")


def _tls(certificate: Path | None, config: Path) -> ssl.SSLContext:
    if certificate is None:
        from rastrainer_simulator.net.views.certificate import own_certificate

        return own_certificate(config).tls
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate)
    except (OSError, ValueError) as error:
        raise InputError(
            f"{printable_name(certificate)} is no certificate with its private key (PEM): "
            f"{failure_reason(error)}."
        ) from None
    return context


COMMANDS = (
    Subcommand(
        "lti",
        "let a course of a learning platform launch RASTrainer, and return grades (LTI 1.3)",
        run,
        (
            arg.study(nargs="?"),
            arg.flag("--show", "print what the platform's administrator enters"),
            arg.number("--port", DEFAULT_LTI_PORT, "to listen on, 0 for any free one"),
            arg.flag(
                "--lan",
                "listen in the network, by TLS (default: on this computer only, for a reverse "
                "proxy)",
            ),
            arg.path(
                "--certificate",
                "FILE",
                "PEM with private key and chain, for --lan (default: one made on this computer)",
            ),
            arg.CONFIG,
        ),
        "Serves launches by LTI 1.3 until Ctrl-C: a learner of a course becomes a trainee of the "
        "study, under a pseudonym, and their scores become grades of the course. Nothing but these "
        "grades is sent. Platforms are registered in lti.json in the folder of settings.",
    ),
)
