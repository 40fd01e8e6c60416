// Counts the units of a bake by stage, and explains which were reused and why the others were not.
#ifndef OCTALUX_CLI_WORK_REPORT_H
#define OCTALUX_CLI_WORK_REPORT_H

#include "report.h"

#include <octalux/bake.h>

enum { WORK_STAGES = 24, WORK_REASONS = 4 };

// The units of one stage that were computed for one reason.
typedef struct work_reason {
  char why[64];
  uint32_t count;
} work_reason;

typedef struct work_stage {
  char name[16];
  uint32_t found, made;
  work_reason reasons[WORK_REASONS]; // those with a count of 0 are unused; the last one also counts further reasons
} work_stage;

// Counts of the units of a bake. Zero-initialize.
typedef struct work_report {
  work_stage stages[WORK_STAGES];
  uint32_t stage_count;
  uint32_t made, found;
} work_report;

void count_work_unit(work_report *report, const olx_bake_unit *unit);
// Prints a line for each stage.
void print_work_report(const work_report *report);
// Adds an array "stages" with an object for each stage.
void add_work_report(cJSON *object, const work_report *report);

#endif
