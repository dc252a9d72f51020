"""Gamepads, keys and headset controllers: what each input does, and who holds the control."""
