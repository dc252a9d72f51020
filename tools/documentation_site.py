"""Hook of MkDocs: makes one site of the repository's pages and the reference of all packages.

Every page has the place in the site that it has in the repository, so that one and the same link
leads there in both. A link to a file that is no page leads to the repository where it is hosted.
The reference has a page for each folder of the packages, made of the docstrings of its modules; it
reads the sources and runs none of them.
"""

import ast
import re
import subprocess
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
SITE_FILES = ("*.md", "docs/*.css", "docs/pictures/*", "Screenshots/*", "assets/scenarios/*.png")
NO_PAGES = (".github/",)
PACKAGES = (
    ("The domain and the Slicer side", "RASTrainer/Logic/rastrainer"),
    ("The simulator", "RASTrainerSimulatorServer/rastrainer_simulator"),
    ("The Slicer side without Slicer", "RASTrainerSimulatorServer/rastrainer_headless"),
)
LINK = re.compile(r"(\]\()([^)#\s:]+)((?:#[^)\s]*)?\))")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Take the pages of the whole repository, and add the reference and its menu."""
    site = Files([file for file in files if file.src_dir != config.docs_dir])
    # Those that git knows, or that are new and not ignored.
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *SITE_FILES]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    names = [name for name in listed.splitlines() if (ROOT / name).exists()]
    for name in names:
        if name.startswith(NO_PAGES):
            continue
        site.append(File(name, str(ROOT), config.site_dir, config.use_directory_urls))
    reference = [{title: _add_package(site, config, ROOT / place)} for title, place in PACKAGES]
    for entry in config.nav:
        if "Reference" in entry:
            entry["Reference"] += [part for part in reference if all(part.values())]
    return site


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links to files that are no pages lead to the repository where it is hosted."""
    folder = (ROOT / page.file.src_uri).parent

    def hosted(link: re.Match) -> str:
        target = (folder / link[2]).resolve()
        if not target.is_relative_to(ROOT) or not target.exists():
            return link[0]
        name = target.relative_to(ROOT).as_posix()
        if files.get_file_from_path(name) is not None:
            return link[0]
        if files.get_file_from_path(f"{name}/README.md") is not None:
            return f"{link[1]}{link[2].rstrip('/')}/README.md{link[3]}"
        kind = "tree" if target.is_dir() else "blob"
        return f"{link[1]}{config.repo_url.rstrip('/')}/{kind}/main/{name}{link[3]}"

    return LINK.sub(hosted, markdown)


def _add_package(site: Files, config: MkDocsConfig, package: Path) -> list[dict[str, Any]]:
    """Add a page for each folder of a package that has modules; return the menu of them."""
    menu = []
    for folder in [package, *sorted(path for path in package.rglob("*") if path.is_dir())]:
        modules = [path for path in sorted(folder.glob("*.py")) if not path.name.startswith("_")]
        if not modules:
            continue
        name = folder.relative_to(package.parent).as_posix()
        uri = f"reference/{name}.md"
        initializer = folder / "__init__.py"
        said = ""
        if initializer.exists():
            said = ast.get_docstring(ast.parse(initializer.read_text(encoding="utf-8"))) or ""
        dotted = name.replace("/", ".")
        parts = [f"# {dotted}", said, *(f"::: {dotted}.{module.stem}" for module in modules)]
        content = "\n\n".join(part for part in parts if part) + "\n"
        site.append(File.generated(config, uri, content=content))
        menu.append({dotted: uri})
    return menu
