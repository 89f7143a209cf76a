import numpy as np
import pytest

from springpot.codegen.errors import UsageError
from springpot.host.recording import protocols


def test_training_is_27_cycles_of_48_850_samples():
    profiles = protocols.training()
    assert len(profiles) == 27 and sum(len(profile.command_n) for profile in profiles) == 48_850
    names = [profile.name for profile in profiles]
    assert sorted(set(names)) == names
    pairs = {
        (p.metadata["amplitude_n"], round(1 / p.metadata["frequency_hz"], 9)) for p in profiles
    }
    periods_s = [5, 4, 3, 2, 1, 0.5, round(1 / 3, 9), 0.25, 0.2]
    assert pairs == {(a, t) for a in (2, 6, 10) for t in periods_s}


def test_a_training_profile_is_one_cycle_of_equation_1():
    for profile in protocols.training():
        amplitude_n, frequency_hz = (
            profile.metadata["amplitude_n"],
            profile.metadata["frequency_hz"],
        )
        assert abs(len(profile.command_n) - 1000 / frequency_hz) < 1
        assert profile.command_n[0] == 0 and 0 <= profile.command_n[-1] < 3e-4 * amplitude_n
        assert profile.command_n.max() == pytest.approx(amplitude_n, rel=1e-4)
        quarter_ms = np.arange(len(profile.command_n)) == round(250 / frequency_hz)
        steepest_npms = np.pi * frequency_hz * amplitude_n / 1000
        assert profile.command_n[quarter_ms] == pytest.approx(amplitude_n / 2, abs=steepest_npms)


def test_validation_signals_peak_at_10_n_and_end_at_zero():
    profiles = protocols.validation(3)
    assert [len(profile.command_n) for profile in profiles] == [15_000] * 10
    for profile in profiles:
        command_n = profile.command_n
        assert command_n[0] == 0 and command_n.min() >= 0
        assert command_n.max() == pytest.approx(10) and command_n[-1] < 0.01
        last_zero_s = max(
            np.floor(15 * frequency_hz) / frequency_hz
            for frequency_hz in profile.metadata["frequency_hz"]
        )
        assert not command_n[int(np.ceil(last_zero_s * 1000)) :].any()
        amplitudes_n = np.array(profile.metadata["amplitude_n"])
        assert amplitudes_n.max() / amplitudes_n.min() <= 5  # drawn from 0.2 .. 1


def test_a_users_file(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        "[[profile]]\namplitude_n = 4\nfrequency_hz = 2.5\ncycles = 3\n"
        "[[profile]]\namplitude_n = 5\nhold_s = 8\nrise_s = 0.25\n"
    )
    cycles, hold = protocols.load_protocol(str(file), 0)
    assert len(cycles.command_n) == 1200
    assert cycles.command_n[[200, 400, 600]] == pytest.approx([4, 0, 4])
    assert len(hold.command_n) == 8000 and hold.command_n[250] == 5
    assert hold.command_n[125] == pytest.approx(2.5)


def test_each_press_is_made_at_each_place(tmp_path):
    file = tmp_path / "map.toml"
    file.write_text('places_m = [[0.0, 0.01], [0.02, -0.01]]\nprotocol = "paper"\n')
    profiles = protocols.load_protocol(str(file), 0)
    assert len(profiles) == 54
    assert [profile.place_m for profile in profiles[26:28]] == [(0.0, 0.01), (0.02, -0.01)]
    names = [profile.name for profile in profiles]
    assert sorted(set(names)) == names


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("[[profile]]\namplitude_n = -4\nfrequency_hz = 1\n", "profile.0.amplitude_n"),
        ("[[profile]]\namplitude_n = nan\nfrequency_hz = 1\n", "profile.0.amplitude_n"),
        ("[[profile]]\namplitude_n = 4\nfrequency = 1\n", "profile.0.frequency"),
        ("[[profile]]\namplitude_n = 4\n", "either frequency_hz"),
        ("[[profile]]\namplitude_n = 4\nfrequency_hz = 1\nhold_s = 3\n", "either frequency_hz"),
        ("[[profile]]\namplitude_n = 4\nhold_s = 0.1\n", "hold_s 0.1 is shorter"),
        ("profile = []\n", "either [[profile]] tables"),
        ('protocol = "paper"\n[[profile]]\namplitude_n = 4\nhold_s = 3\n', "either [[profile]]"),
        ('protocol = "papers"\n', "protocol"),
        ('places_m = [[0, 2]]\nprotocol = "paper"\n', "places_m.0.1"),
        ("[[profile]\n", "not a protocol file"),
    ],
)
def test_a_wrong_file_names_the_key(tmp_path, text, named):
    file = tmp_path / "wrong.toml"
    file.write_text(text)
    with pytest.raises(UsageError) as caught:
        protocols.load_protocol(str(file), 0)
    message = str(caught.value)
    assert named in message and str(file) in message and "\n" not in message


def test_a_multisine_comes_and_goes_and_reaches_its_peak():
    """As a hand may leave it: a force that steps to zero throws the tool."""
    (multisine,) = [p for p in protocols.extended(3) if p.metadata["kind"] == "multisine"]
    command_n = multisine.command_n
    assert command_n.min() >= 0.0 and command_n.max() == pytest.approx(10.0)
    assert command_n[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-3)
    second = protocols.RATE_HZ
    assert command_n[:50].max() < 0.2 and command_n[-50:].max() < 0.2
    assert command_n[second:-second].std() > 1.0
