#!/bin/bash
# A PrologSlurmctld: a job of this name is in the state CONFIGURING for some seconds, as where nodes
# are switched on for jobs.
[ "$SLURM_JOB_NAME" != slow-prolog ] || sleep 5
