"""Views of the local network: only by TLS, with a certificate that can be compared."""

from __future__ import annotations

import socket
import ssl

import pytest

from rastrainer_simulator.net.views.certificate import FILE_NAME, own_certificate
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
    """Return a connection over a single version of TLS that does not check the certificate."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    # A client would refuse old versions by default, and prove nothing.
    context.set_ciphers("ALL:@SECLEVEL=0")
    context.minimum_version = context.maximum_version = version
    return context.wrap_socket(socket.create_connection((HOST, port), 60))


def test_the_page_is_served_over_tls_1_2_and_1_3(port):
    for version in (ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3):
        with connected(port, version) as browser:
            browser.sendall(REQUEST)
            assert browser.recv(100).startswith(b"HTTP/1.1 200")


@pytest.mark.filterwarnings("ignore:ssl.TLSVersion:DeprecationWarning")
def test_tls_older_than_1_2_is_refused(port, certificates):
    version = ssl.TLSVersion.TLSv1_1
    # The server refuses, not this side.
    with pytest.raises(ssl.SSLError, match=r"(?i)alert protocol version|EOF"):
        connected(port, version)
    # Even if the system's OpenSSL would allow it.
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
