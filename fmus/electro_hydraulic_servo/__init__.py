"""The electro-hydraulic servo of Raheem (2013)."""
