"""Registration by points or by a trace: fits, checks, faults, expected and true target error."""
