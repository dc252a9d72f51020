"""Charts as SVG text, drawn by ourselves: they print sharply and need no script."""
