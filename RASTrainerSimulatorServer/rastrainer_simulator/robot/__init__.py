"""The robot: its model from a URDF, its kinematics, and FABRIK."""
