"""System Structure and Parameterization (SSP): systems as other tools read and write them."""
