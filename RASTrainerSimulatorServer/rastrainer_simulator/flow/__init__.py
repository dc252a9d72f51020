"""The trainee's path from the first menu to the result: menus, instructions, controls."""
