"""What `run` says at its end, and what `validate` says of its log."""

from pathlib import Path

from support.in_process import spring


def test_a_log_is_compared_with_the_c_and_leaves_the_validation_alone(job: Path) -> None:
    press_file, log = job / "press.h5", job / "felt.h5"
    validated = spring("validate", job / "c", "--recording", press_file)
    assert "mean error" in validated.stdout
    noted = " ".join(validated.stdout.split())
    assert "ticks with notes resync 1 (history begins anew here)" in noted
    before = (job / "c" / "validation" / "result.json").read_text()
    device = f"replay://{press_file}"
    spring("run", "--scene", job / "c", "--device", device, "--log", log)
    felt = spring("validate", job / "c", "--recording", log)
    assert felt.returncode == 0, felt.stderr
    words = " ".join(felt.stdout.split())
    assert "what was felt is what the model says" in words
    assert "not with a measured object" in words
    assert "RMSE" not in words
    assert (job / "c" / "validation" / "result.json").read_text() == before
    other = spring("run", "--scene", job / "c", "--device", "sim://ecoflex-00-30?variant=b")
    assert other.returncode == 2 and "leave them out where a scene is rendered" in other.stderr
