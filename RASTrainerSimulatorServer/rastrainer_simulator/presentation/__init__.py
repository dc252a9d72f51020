"""What views show: screens as data, events with sound and vibration, and who presents them."""
