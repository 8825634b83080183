"""The second actuator of Ahn & Truong (2009), which moves the far end of the spring."""
