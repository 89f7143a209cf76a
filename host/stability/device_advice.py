"""What the figures that the scene states of its device mean for its forces, in sentences."""

from collections.abc import Iterator

from springpot.codegen.plan.plan import Plan


def device_advice(plan: Plan) -> Iterator[str]:
    """Yield what the largest force and the noise of the velocity, where stated, mean."""
    device = plan.scene.device
    if device.max_force_n is not None and device.max_force_n < plan.max_force_n:
        yield (
            f"The scene's force may reach {plan.max_force_n:.3g} N and its device gives "
            f"{device.max_force_n:g} N, so `run` will refuse it: set guard.max_force_n = "
            f"{device.max_force_n:g}."
        )
    if device.velocity_noise_mps and plan.needs_device_velocity:
        noise_n = plan.coupling.coupling.damping_nspm * device.velocity_noise_mps
        yield (
            f"The device's velocity, noisy by {device.velocity_noise_mps:.2g} m/s, puts "
            f"{noise_n:.2g} N of noise into the force: "
            'device.velocity = "estimate" does without it.'
        )
