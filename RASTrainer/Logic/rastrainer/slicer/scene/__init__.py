"""What stands in the MRML scene."""
