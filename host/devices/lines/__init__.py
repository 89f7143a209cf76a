"""What carries a device's messages: serial ports, CAN buses, the wire of springpot serial."""
