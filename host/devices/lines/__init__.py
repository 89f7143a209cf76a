"""Lines to a device: serial ports, CAN buses, the wire of springpot serial."""
