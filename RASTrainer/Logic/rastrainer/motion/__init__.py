"""Motion metrics of a trial, from the recorded trajectory of the tool."""
