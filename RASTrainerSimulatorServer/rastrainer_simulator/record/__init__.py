"""The record of trials: journals, what is still to be delivered, and replay."""
