# Slicer writes its own files about an extension here; none of them concerns what is in it.
