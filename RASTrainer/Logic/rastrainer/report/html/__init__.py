"""The HTML of a report: its page and the elements in it."""
