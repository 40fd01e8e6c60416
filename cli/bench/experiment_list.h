// Every experiment, each in a file of its own.
#ifndef OCTALUX_CLI_EXPERIMENT_LIST_H
#define OCTALUX_CLI_EXPERIMENT_LIST_H

#include "experiment.h"

olx_result run_mcguire_leaks(bench *b);
olx_result run_mcguire_resolution(bench *b);
olx_result run_mcguire_count(bench *b);

#endif
