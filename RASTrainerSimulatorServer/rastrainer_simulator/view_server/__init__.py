"""How views join: pairing, the scene, its stream and the input, as told in docs/views.md."""
