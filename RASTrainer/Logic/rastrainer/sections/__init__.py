"""The sections of the module: of each, what it does without Qt, and the panel that shows it."""
