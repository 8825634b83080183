"""What is put on wires: signals, noise, disturbances, sensor imperfections."""
