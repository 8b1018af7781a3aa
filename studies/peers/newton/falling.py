"""Cloth that falls from its pattern by `newton.solvers.SolverVBD`, step by step until forces balance, or time is up."""

import time

import newton
import numpy as np
import warp as wp
from forces import ClothForces, hinge_stiffness

VERSION = f"Newton {newton.__version__}"
MOST = 60.0
"""Seconds of the processor after which a fall is given up; kernels are compiled before."""
OFTEN = 20
"""Steps between two looks at the residual, which are not counted."""


class Falling:
    """A fall.

    Args:
        mesh: of the pattern, in the plane z = 0; parameters: of the cloth.

    What a kind of fall says: step [s] of time, passes over all vertices in a step, and whether cloth is stopped at each
    peak of its kinetic energy (kinetic damping).
    """

    step = 1 / 600
    passes = 10
    stopped = False

    def __init__(self, mesh, parameters):
        wp.config.quiet = True
        self.mesh, self.given, self.short = mesh, parameters, ""

    def _made(self, points):
        """A model of Newton's, and its forces."""
        given, mesh = self.given, self.mesh
        flat = np.column_stack([points, np.zeros(len(points))])
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -given["gravity"]))
        builder.add_cloth_mesh(
            pos=wp.vec3(0.0, 0.0, 0.0),
            rot=wp.quat_identity(),
            scale=1.0,
            vel=wp.vec3(0.0, 0.0, 0.0),
            vertices=[wp.vec3(*place) for place in flat.tolist()],
            indices=mesh.cells.ravel().tolist(),
            density=given["density"],
            tri_ke=given["mu"],
            tri_ka=given["lam"],
            tri_kd=0.0,
            edge_ke=1.0,
            edge_kd=0.0,
            particle_radius=1e-3,
        )
        edges = np.array(builder.edge_indices)
        stiffness = hinge_stiffness(flat, edges, given["bending"])
        builder.edge_bending_properties = [(float(one), 0.0) for one in stiffness]
        pins = [int(np.intersect1d(mesh.nodes_on(one), mesh.nodes_on(two))[0]) for one, two in given["pins"]]
        for pin in pins:
            builder.particle_mass[pin] = 0.0
            builder.particle_flags[pin] &= ~int(newton.ParticleFlags.ACTIVE)
        builder.color(include_bending=True)
        weight = given["density"] * given["gravity"]
        forces = ClothForces(points, mesh.cells, edges, stiffness, given["lam"], given["mu"], weight, pins)
        return builder.finalize(), forces, flat

    def frame(self, points):
        """(n, 3) [m] displacements at the end of the fall; `short` says where no balance was found."""
        model, forces, flat = self._made(points)
        solver = newton.solvers.SolverVBD(model, iterations=self.passes, particle_enable_self_contact=False)
        now, then, control = model.state(), model.state(), model.control()
        solver.step(now, then, control, None, self.step)  # compiles
        now.assign(model.state())
        used, steps, speed = 0.0, 0, 0.0
        while True:
            begun = time.process_time()
            for _ in range(OFTEN):
                now.clear_forces()
                solver.step(now, then, control, None, self.step)
                now, then = then, now
                speed = self._stop(now, speed) if self.stopped else 0.0
            used, steps = used + time.process_time() - begun, steps + OFTEN
            x = now.particle_q.numpy().astype(float)
            residual = forces.residual(x)
            if residual <= self.given["residual"]:
                break
            if used > MOST:
                self.short = f"a residual of {residual:.1e} of the weight after {used:.0f} s and {steps} steps"
                break
        return x - flat

    @staticmethod
    def _stop(state, speed):
        """Takes the velocities away where they have just become smaller; what they are now."""
        velocities = state.particle_qd.numpy()
        now = float((velocities**2).sum())
        if now < speed:
            state.particle_qd.zero_()
            return 0.0
        return now
