"""The two-mass drive: a motor that turns a load through an elastic shaft."""
