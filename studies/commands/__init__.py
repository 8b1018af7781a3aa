"""Commands that studies add to `restshape`."""
