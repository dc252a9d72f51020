"""Reading and writing files safely: content from outside is hostile until checked."""
