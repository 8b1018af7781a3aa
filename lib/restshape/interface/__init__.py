"""The library for programs: what `import restshape` offers."""
