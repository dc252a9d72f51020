"""Views of the local network: by TLS alone, with a certificate that can be compared."""

from __future__ import annotations

import hashlib
import os
import socket
import ssl
import tempfile
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.net.views.certificate import FILE_NAME, own_certificate
from Testing.forked_child import in_child
from Testing.simulator.net.igtl.servers import HOST
from Testing.simulator.net.views.served import ViewClient

REQUEST = f"GET / HTTP/1.1\r\nHost: {HOST}\r\nConnection: close\r\n\r\n".encode()


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """Return a folder with a certificate."""
    folder = tmp_path_factory.mktemp("certificates")
    own_certificate(folder)
    return folder


@pytest.fixture
def port(served, certificates):
    """Return the port on which the local network is served."""
    return served.thread.run(served.server.listen_in_network(0, own_certificate(certificates).tls))


def connected(port: int, version: ssl.TLSVersion) -> ssl.SSLSocket:
    """Return a connection by exactly one version of TLS, to a certificate that is not checked."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    # A client of its own default would refuse to speak an old version, and prove nothing.
    context.set_ciphers("ALL:@SECLEVEL=0")
    context.minimum_version = context.maximum_version = version
    return context.wrap_socket(socket.create_connection((HOST, port), 60))


@pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3])
def test_the_page_is_served_over_tls_1_2_and_1_3(port, version):
    with connected(port, version) as browser:
        browser.sendall(REQUEST)
        assert browser.recv(100).startswith(b"HTTP/1.1 200")


@pytest.mark.filterwarnings("ignore:ssl.TLSVersion:DeprecationWarning")
@pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1])
def test_tls_older_than_1_2_is_refused(port, certificates, version):
    # By the server, and not by this side.
    with pytest.raises(ssl.SSLError, match=r"(?i)alert protocol version|EOF"):
        connected(port, version)
    # Where the system's own OpenSSL would allow it, too.
    assert own_certificate(certificates).tls.minimum_version > version


def test_a_view_that_sends_nothing_is_sent_everything_over_tls_too(serve, certificates):
    # So long that no ping of the server makes the view answer.
    served = serve(gone_s=1000.0)
    port = served.thread.run(served.server.listen_in_network(0, own_certificate(certificates).tls))
    with ViewClient(served.thread, f"https://{HOST}:{port}", served.new_key()) as view:
        view.join()
        ticks = [view.next("state")["tick"] for _ in range(20)]
    assert ticks == sorted(set(ticks))


def test_a_certificate_is_kept_and_a_truncated_one_is_replaced(tmp_path):
    first = own_certificate(tmp_path).fingerprint
    assert own_certificate(tmp_path).fingerprint == first
    file = tmp_path / FILE_NAME
    file.write_bytes(file.read_bytes()[:700])
    assert own_certificate(tmp_path).fingerprint != first


def test_the_fingerprint_is_the_served_certificates_even_if_another_start_replaces_the_file(
    served, tmp_path, monkeypatch
):
    other, load = tmp_path / "other", ssl.SSLContext.load_cert_chain
    own_certificate(other)

    def load_and_be_replaced(context, file):
        load(context, file)
        if (other / FILE_NAME).exists():
            (other / FILE_NAME).replace(file)

    monkeypatch.setattr(ssl.SSLContext, "load_cert_chain", load_and_be_replaced)
    certificate = own_certificate(tmp_path / "own")
    port = served.thread.run(served.server.listen_in_network(0, certificate.tls))
    with connected(port, ssl.TLSVersion.TLSv1_3) as browser:
        shown = hashlib.sha256(browser.getpeercert(binary_form=True))
    assert certificate.fingerprint == shown.digest().hex(":").upper()


def refused_without_permission(folder: Path) -> str:
    if os.getuid() == 0:
        os.setuid(65534)
    with pytest.raises(InputError) as refused:
        own_certificate(folder / "certificates")
    return str(refused.value)


def test_a_folder_that_cannot_be_written_to_is_reported():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o555)
        said = in_child(refused_without_permission, Path(folder))
        Path(folder).chmod(0o755)
    assert said.startswith("The certificate for the local network cannot be kept in ")
    assert "Permission denied" in said
    assert "choose another folder of settings" in said
