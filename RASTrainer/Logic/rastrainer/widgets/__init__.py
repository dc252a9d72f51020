"""Qt widgets as all sections of the module use them."""
