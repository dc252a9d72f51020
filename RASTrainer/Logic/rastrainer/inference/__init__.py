"""What follows from a study's numbers: paired tests, effect sizes, intervals, power."""
