"""The sections of a report; each gives its HTML, or "" where a study has nothing for it."""
