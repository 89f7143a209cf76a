"""The perceptual study of the paper's section VI: does it feel like the object?"""

from springpot.console import LazyCommand

STUDY = LazyCommand(
    "springpot.host.wings.study.commands:study",
    "Does it feel like the object? Plan a study, run it with people, and report.",
    20,
)
