"""A study's protocol: who does what in which order, what comes next, what was done."""
