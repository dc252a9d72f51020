"""Logs, child processes and folders of the running program."""
