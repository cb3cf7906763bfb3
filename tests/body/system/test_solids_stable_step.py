"""The automatic step of explicit solids keeps distorted meshes stable; stable_step.c holds it against eigenvalues."""

import pytest
from solidmeshes import SHAPES, dim_of, write_box


@pytest.mark.parametrize("shape", list(SHAPES))
def test_stable(impakt, tmp_path, shape):
    """At least 3000 automatic steps of central differences on a distorted mesh, nearly incompressible: no energy comes from nowhere. A step beyond the stable
    one multiplies the highest mode in each step, and would be seen after a hundred."""
    dim = dim_of(shape)
    write_box(tmp_path / "distorted.msh", shape, (5, 4, 3)[:dim], (1.0, 0.8, 0.6), 0.25)
    # rough in space, so that all modes take part
    velocity = ",".join(f"1e-3*sin({97 + 13 * i}*x+{71 - 5 * i}*y+{31 + 7 * i}*z)" for i in range(dim))
    options = f"-bodies b -b_dm_plex_filename {tmp_path / 'distorted.msh'} -b_density 1000 -b_youngs_modulus 1e9 -b_poissons_ratio 0.45 -b_initial_velocity {velocity} -b_ts_type centraldifference -b_ts_time_step auto"
    run = impakt(f"{options} -time_step 1e-3 -time_end {0.2 if dim == 3 else 0.3}")
    assert run.summary["bodies"]["b"]["substeps"] >= 3000
    system = run.summary["system"]
    assert max(-system["energy_error_min"], system["energy_error_max"]) <= 1e-11  # the staggered energy of a linear body is kept: 1e-13 measured
