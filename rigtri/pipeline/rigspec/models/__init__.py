"""The options of each step as specs may say them: the commands' names, values and defaults."""
