"""A search by coverage finds no bytes that break the decoder."""

import importlib.util
import re
import subprocess
import sys

import pytest

RUNS = 300_000
DONE = re.compile(r"Done (\d+)")


@pytest.mark.soak
def test_a_coverage_guided_search_finds_no_bytes_that_break_the_decoder(tmp_path, capsys):
    assert importlib.util.find_spec("atheris"), (
        "Install what `make soak` needs: atheris is missing. It has wheels for Linux and macOS, "
        "Python 3.11 and newer."
    )
    words = [f"-atheris_runs={RUNS}", "-seed=1", "-max_len=4096", "-rss_limit_mb=1024"]
    module = "Testing.security.fuzz_decoder"
    found = tmp_path / "found"
    found.mkdir()
    words += ["-timeout=10", f"-artifact_prefix={tmp_path}/broken-"]
    # Started by a shell: a process inherits its parent's peak of memory.
    done = subprocess.run(
        ["sh", "-c", '"$@"; exit $?', "sh", sys.executable, "-m", module, *words, str(found)],
        capture_output=True,
        text=True,
        check=False,
    )
    covered = re.findall(r"cov: (\d+) ft: (\d+)", done.stderr)
    with capsys.disabled():
        print(f"\n{RUNS} inputs; branches and features {covered[0]} at first, then {covered[-1]}")
    assert done.returncode == 0, done.stderr[-3000:]
    assert not list(tmp_path.glob("broken-*"))
