"""The hybrid electro-hydraulic actuator of Ahn & Truong (2009) under force control."""
