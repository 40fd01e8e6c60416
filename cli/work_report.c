// Counts the units of a bake by stage and by the reason for which they were computed, and prints the counts.
#include "work_report.h"

#include <stdio.h>
#include <string.h>

static work_stage *stage_of(work_report *report, const char *name) {
  for (uint32_t i = 0; i < report->stage_count; i++) {
    if (strcmp(report->stages[i].name, name) == 0) return &report->stages[i];
  }
  if (report->stage_count == WORK_STAGES) return NULL;
  work_stage *stage = &report->stages[report->stage_count++];
  snprintf(stage->name, sizeof stage->name, "%s", name);
  return stage;
}

static void count_reason(work_stage *stage, const char *why) {
  uint32_t i = 0;
  while (i + 1 < WORK_REASONS && stage->reasons[i].count > 0 && strcmp(stage->reasons[i].why, why) != 0) i++;
  if (stage->reasons[i].count == 0) snprintf(stage->reasons[i].why, sizeof stage->reasons[i].why, "%s", why);
  stage->reasons[i].count++;
}

void count_work_unit(work_report *report, const olx_bake_unit *unit) {
  work_stage *stage = stage_of(report, unit->stage);
  if (unit->found) report->found++;
  else report->made++;
  if (!stage) return;
  if (unit->found) stage->found++;
  else stage->made++;
  if (!unit->found) count_reason(stage, unit->why);
}

// Reasons that name no parts of the scene, and what follows "because" for each.
static const struct {
  const char *why, *words;
} REASONS[] = {{"new", "not stored before"},
               {"unreadable", "its file could not be read"},
               {"damaged", "its file was damaged"},
               {"another scene", "it was of another scene"}};

// Returns a reason in words, or NULL for the names of changed parts.
static const char *in_words(const char *why) {
  for (size_t i = 0; i < sizeof REASONS / sizeof *REASONS; i++) {
    if (strcmp(why, REASONS[i].why) == 0) return REASONS[i].words;
  }
  return NULL;
}

void print_work_report(const work_report *report) {
  for (uint32_t i = 0; i < report->stage_count; i++) {
    const work_stage *stage = &report->stages[i];
    printf("  %-10s %u reused, %u computed", stage->name, stage->found, stage->made);
    for (uint32_t k = 0; k < WORK_REASONS && stage->reasons[k].count > 0; k++) {
      const work_reason *reason = &stage->reasons[k];
      const char *words = in_words(reason->why);
      printf("%s %u because %s%s", k ? "," : ":", reason->count, words ? "" : "of other ", words ? words : reason->why);
    }
    printf("\n");
  }
}

void add_work_report(cJSON *object, const work_report *report) {
  cJSON *stages = cJSON_AddArrayToObject(object, "stages");
  for (uint32_t i = 0; i < report->stage_count; i++) {
    const work_stage *stage = &report->stages[i];
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "stage", stage->name);
    add_number(row, "reused", stage->found);
    add_number(row, "computed", stage->made);
    cJSON *reasons = cJSON_AddObjectToObject(row, "why");
    for (uint32_t k = 0; k < WORK_REASONS && stage->reasons[k].count > 0; k++) {
      add_number(reasons, stage->reasons[k].why, stage->reasons[k].count);
    }
    cJSON_AddItemToArray(stages, row);
  }
}
