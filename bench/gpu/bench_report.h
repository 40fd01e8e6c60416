// The output of the benchmark: text, or one JSON object.
#ifndef OCTALUX_BENCH_REPORT_H
#define OCTALUX_BENCH_REPORT_H

#include "bench_row.h"

typedef struct bench_report {
  const gpu_device *device;
  const bench_settings *settings;
  double copy_gigabytes; // measured copy bandwidth in gigabytes per second
  bool stated;           // settings->gigabytes comes from the command line
  uint32_t count;
  const bench_row **rows;
  const bench_result *results;
} bench_report;

void bench_report_text(const bench_report *report);
void bench_report_json(const bench_report *report);

#endif
