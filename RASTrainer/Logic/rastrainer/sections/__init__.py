"""The sections of the module: each has logic without Qt, and a panel that shows it."""
