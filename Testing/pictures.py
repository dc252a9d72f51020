"""Pictures of the documentation, in small files: the repository keeps every one for ever."""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

WIDEST_PX = 1400
MOST_BYTES = 120_000
QUALITIES = range(92, 30, -6)


def keep_picture(source: Path | bytes | Image.Image, path: Path) -> None:
    """Write a picture in the format of its path, as well as its file may be; a file moves there."""
    opened = Image.open(io.BytesIO(source)) if isinstance(source, bytes) else source
    picture = Image.open(opened) if isinstance(opened, Path) else opened
    kept = picture.convert("RGB")
    kept.thumbnail((WIDEST_PX, 10 * WIDEST_PX))
    for quality in QUALITIES:
        content = io.BytesIO()
        kept.save(content, Image.registered_extensions()[path.suffix], quality=quality)
        if content.tell() <= MOST_BYTES:
            break
    else:
        raise AssertionError(f"{path.name} does not fit into {MOST_BYTES} bytes.")
    path.write_bytes(content.getvalue())
    if isinstance(source, Path):
        source.unlink()
    print(path.name, content.tell(), flush=True)
