"""The paper's presses of a simulated silicone, by a bench that controls the force."""

from springpot.host.recording.protocols import RATE_HZ, load_protocol
from springpot.host.recording.session import open_press_device
from springpot.trainer.recordings.recording import Recording


def paper_presses(name: str) -> tuple[Recording, ...]:
    """The 27 training presses of an object."""
    return _pressed(name, "paper", 1)


def validation_signals(name: str, number: int) -> tuple[Recording, ...]:
    """The first of the ten validation signals of an object."""
    return _pressed(name, "validation", 2)[:number]


def _pressed(name: str, protocol: str, seed: int) -> tuple[Recording, ...]:
    device = open_press_device(f"sim://{name}?variant=a", seed)
    return tuple(
        Recording(f"{name}-{profile.name}", *device.press(profile.command_n), 1 / RATE_HZ)
        for profile in load_protocol(protocol, seed)
    )
