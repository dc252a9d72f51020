"""The module's panels: thin Qt widgets over the logic in `rastrainer.slicer`."""
