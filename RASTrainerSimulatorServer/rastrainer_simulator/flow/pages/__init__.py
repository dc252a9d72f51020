"""The pages of the menus, in the order of the paper's figure 4."""
