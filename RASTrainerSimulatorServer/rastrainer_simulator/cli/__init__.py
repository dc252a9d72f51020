"""The command `rastrainer`; subcommands for the same thing share a file."""
