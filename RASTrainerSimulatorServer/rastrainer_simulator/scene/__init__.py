"""The scene that every view draws: one GLB a task, made of the robot, the head and the room."""
