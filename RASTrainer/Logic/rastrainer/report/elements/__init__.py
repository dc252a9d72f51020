"""The building blocks of a report: HTML, charts, comparisons and scores."""
