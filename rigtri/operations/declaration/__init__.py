"""One declaration of each option, of which the command line, specs and the library's keywords are made."""
