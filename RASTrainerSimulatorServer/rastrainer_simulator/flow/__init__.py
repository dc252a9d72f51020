"""The trainee's way from the first menu to the result: menus, instructions, controls."""
