"""The content of the MRML scene."""
