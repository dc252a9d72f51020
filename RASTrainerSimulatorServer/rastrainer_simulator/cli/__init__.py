"""The command `rastrainer`, one subcommand a file."""
