"""One module a tool: how its user closes the loop. They run without this project's packages."""
