"""What `restshape bench body` refuses."""

from argparse import ArgumentParser

import pytest
from restshape_studies.commands import bench_body

from restshape.errors import UserError


@pytest.mark.parametrize("spacing", ["inf", "nan", "0", "-1"])
def test_a_grid_has_a_finite_spacing(spacing):
    parser = ArgumentParser()
    bench_body.declare(parser)
    args = parser.parse_args([f"--spacing={spacing}"])
    args.scenes = []
    with pytest.raises(UserError, match="is no spacing"):
        bench_body.check(args)
