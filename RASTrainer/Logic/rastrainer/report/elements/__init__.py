"""The building blocks of a report: HTML, SVG and comparisons."""
