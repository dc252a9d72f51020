"""Reading and writing files safely: what comes from outside is hostile until checked."""
