"""What each section of the module does, without Qt."""
