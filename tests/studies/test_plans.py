"""Plans of studies: a value that is wrong is refused in one line that names its key."""

from support import ROOT, with_value

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.cage.plan import CagePlan
from workflow.studies.identify.plan import IdentifyPlan

PLANS = {
    "cage": (
        CagePlan,
        ("cage_friction", [0.1, 0.05], "cage_friction: got 0.1, 0.05, expected increasing"),
        ("ensemble.least_turns", 200, "most_turns: got 150, expected at least 200"),
    ),
    "identify": (
        IdentifyPlan,
        ("statements.preload_loss", 0, "preload_loss: got 0, expected a number > 0"),
        ("statements.qv_least_um", [0.5, 0.3], "qv_least_um: got 0.5, 0.3, expected increasing"),
        ("ball_count", [7, 7], "ball_count: got 7, 7, expected increasing numbers"),
        ("pitch_diameter_mm.step", 0, "pitch_diameter_mm: step: got 0, expected a number > 0"),
    ),
}


def test_a_wrong_value_of_a_plan_takes_one_line(tmp_path):
    wrong = []
    for name, (kind, *rows) in PLANS.items():
        for path, value, message in rows:
            file = with_value(ROOT / f"config/{name}.yaml", path, value, tmp_path)
            try:
                read_record(kind, file)
            except ValueError as error:
                if message not in str(error) or "\n" in str(error):
                    wrong.append((name, path, str(error)))
            else:
                wrong.append((name, path, "accepted"))
    assert not wrong
