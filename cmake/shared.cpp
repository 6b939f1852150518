// A shared library needs a source of its own; the code comes from the static libraries.
