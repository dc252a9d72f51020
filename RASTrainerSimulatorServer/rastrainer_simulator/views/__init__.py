"""What people see of the simulation; views draw what it says and decide nothing."""
