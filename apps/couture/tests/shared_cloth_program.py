"""Run by mpiexec: a command line with cloth of any size shared among the ranks."""

import sys

from restshape.cli.main import main
from restshape.physics.cloth.relaxation import relaxation_options

relaxation_options.WHOLE = 0
sys.exit(main(sys.argv[1:]))
