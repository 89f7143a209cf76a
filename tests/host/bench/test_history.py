"""What came before a recording of its session is a part of what a model is measured on."""

from dataclasses import replace

import numpy as np
from support.small import DT_S, passive_model, press

from springpot.codegen.make_plan import make_plan
from springpot.host.bench.measure import bench_scene, prediction_errors
from springpot.host.native.scene_library import build_and_load
from springpot.host.validation.rendered import measure_rendered
from springpot.trainer.models.predict import predict_limited_n
from springpot.trainer.recordings.quality.report import _compare_units
from springpot.trainer.recordings.recording import Recording


def test_a_recording_of_a_session_goes_on_after_those_before() -> None:
    model = passive_model()
    position_m = press(1.0)
    ends_s = len(position_m) * DT_S
    presses = [
        Recording(name, position_m, 900.0 * position_m, DT_S, session="day", start_s=start_s)
        for name, start_s in (("first", 0.0), ("second", ends_s))
    ]
    first, second = (
        replace(item, force_n=force_n)
        for item, force_n in zip(presses, predict_limited_n(model, presses), strict=True)
    )
    plan = make_plan(model, bench_scene("float64"))
    library = build_and_load(plan)
    after = prediction_errors(plan, library, [second], [first])["rmse_n"]
    alone = prediction_errors(plan, library, [second])["rmse_n"]
    assert alone > 5e-4 * second.force_n.max()  # its branches still hold some of the first press
    assert after < 0.2 * alone
    as_emitted, fresh = (measure_rendered(model, [second], before) for before in ([first], []))
    assert as_emitted is not None and fresh is not None
    assert as_emitted.accuracy.rmse_n < fresh.accuracy.rmse_n


def test_recordings_that_never_push_are_no_other_unit() -> None:
    position_m = press(1.0)
    still = [Recording(name, position_m, np.zeros(len(position_m)), DT_S) for name in "abc"]
    assert list(_compare_units(still)) == []
