"""Which stimulus comes next: functions of the answers so far, and of nothing else."""
