// Decides whether each unit is loaded, computed, or left to other parts, and stores computed results.
#include "work/unit_store.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "work/unit_deal.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

// A stage for whose units a part has to wait.
typedef struct awaited_units {
  char stage[16];
  uint32_t round, count; // count 0: none
  olx_scene_parts parts;
} awaited_units;

// A mark with more units than any stage has is not believed.
enum { MOST_AWAITED = 1 << 20 };

struct olx_unit_store {
  olx_unit_store_settings settings;
  char path[PATH_MAX];
  olx_manifest manifest;
  bool joins, full; // `full`: the limit was reached, so that nothing more is stored
  olx_work_folder *folder;
  awaited_units awaited; // those for which OLX_ERROR_INCOMPLETE was returned last
};

static olx_result open_folder(olx_unit_store *s) {
  const olx_work_folder_settings settings = {.manifest = s->joins ? NULL : &s->manifest,
                                             .lock = s->settings.parts || s->joins ? OLX_WORK_SHARED : OLX_WORK_ALONE,
                                             .fresh = s->settings.fresh,
                                             .edited = s->settings.edited};
  return olx_work_folder_open(s->path, &settings, &s->folder);
}

olx_result olx_unit_store_open(const olx_unit_store_settings *settings, olx_unit_store **store) {
  *store = NULL;
  if (strlen(settings->folder) >= PATH_MAX) {
    return olx_fail(OLX_ERROR_FILE, "'%s': cannot be a work folder", settings->folder);
  }
  olx_unit_store *s = olx_allocate_zero(1, sizeof *s);
  if (!s) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", settings->folder);
  s->settings = *settings;
  memcpy(s->path, settings->folder, strlen(settings->folder));
  s->joins = !settings->manifest;
  if (settings->manifest) s->manifest = *settings->manifest;
  const olx_result result = open_folder(s);
  if (result == OLX_OK) *store = s;
  else olx_release(s);
  return result;
}

void olx_unit_store_tidy(olx_unit_store *s) {
  if (s) olx_work_folder_tidy(s->folder);
}

void olx_unit_store_close(olx_unit_store *s, bool remove) {
  if (!s) return;
  if (remove) olx_work_folder_remove(s->folder);
  else olx_work_folder_close(s->folder);
  olx_release(s);
}

bool olx_unit_store_is_part(const olx_unit_store *s) { return s && s->settings.parts > 0; }
bool olx_unit_store_joins(const olx_unit_store *s) { return s && s->joins; }
const olx_manifest *olx_unit_store_manifest(const olx_unit_store *s) { return olx_work_folder_manifest(s->folder); }

static bool is_stored(const olx_unit_store *s, const olx_unit_name *name) {
  return s && olx_work_folder_has(s->folder, name);
}

static olx_unit_name name_of(const olx_unit_stage *stage, uint32_t unit) {
  return (olx_unit_name){stage->name, stage->round, unit, stage->parts};
}

bool olx_units_have(const olx_unit_store *s, const olx_unit_stage *stage) {
  const olx_unit_name name = name_of(stage, 0);
  return is_stored(s, &name);
}

bool olx_units_read_stale(const olx_unit_store *s, const olx_unit_stage *stage, uint32_t unit, void **data,
                          size_t *size_bytes) {
  const olx_unit_name name = name_of(stage, unit);
  *data = NULL;
  const olx_unit_state state = s ? olx_work_folder_look(s->folder, &name) : OLX_UNIT_ABSENT;
  if (state == OLX_UNIT_STALE) olx_work_folder_get_stale(s->folder, &name, data, size_bytes);
  return state != OLX_UNIT_ABSENT;
}

bool olx_units_have_all(const olx_unit_store *s, const char *stage, uint32_t count) {
  for (uint32_t unit = 0; unit < count; unit++) {
    if (!is_stored(s, &(olx_unit_name){stage, 0, unit, OLX_PARTS_ALL})) return false;
  }
  return true;
}

void olx_units_forget(olx_unit_store *s, const char *stage, uint32_t first_round, uint32_t rounds) {
  for (uint32_t round = first_round; s && round < first_round + rounds; round++) {
    olx_work_folder_drop(s->folder, &(olx_unit_name){stage, round, 0, OLX_PARTS_ALL});
  }
}

// Reports a unit of `bytes` that was loaded, or computed for the reason `why`.
static void report(const olx_unit_store *s, const olx_unit_stage *stage, uint32_t unit, const char *why, double start,
                   uint64_t bytes) {
  if (!s || !s->settings.done || !stage->make) return;
  const olx_unit_done done = {name_of(stage, unit), stage->count, *why == '\0', why, olx_seconds() - start, bytes};
  s->settings.done(s->settings.user, &done);
}

// Returns why a unit has to be computed.
static olx_manifest_value reason_for(const olx_unit_store *s, const olx_unit_name *name) {
  const olx_unit_state state = olx_work_folder_look(s->folder, name);
  if (state != OLX_UNIT_STALE) return (olx_manifest_value){"new"};
  const olx_scene_parts edited = olx_work_folder_edited(s->folder);
  const olx_scene_parts changed = name->parts ? name->parts & edited : edited;
  // After an interrupted bake, the folder no longer knows what its units differ in.
  return changed ? olx_manifest_part_names(&s->manifest, changed) : (olx_manifest_value){"another scene"};
}

static olx_unit_deal deal_of(const olx_unit_store *s, const olx_unit_stage *stage) {
  olx_unit_deal deal =
      olx_unit_deal_begin(stage->name, stage->round, stage->count, s->settings.part, s->settings.parts);
  deal.helps = s->settings.wait != NULL;
  return deal;
}

static olx_result load_bytes(const olx_unit_stage *stage, uint32_t unit, const void *data, size_t size_bytes) {
  olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
  OLX_TRY(stage->load(stage->user, unit, &reader));
  return olx_bytes_end(&reader, stage->name);
}

// What became of a unit that was to be loaded.
typedef enum unit_fate {
  UNIT_LOADED = 0,
  UNIT_MISSING,   // or of another scene
  UNIT_DAMAGED,   // and removed
  UNIT_UNREADABLE // but kept, because another program, or another time, may read it: olx_last_error() says why
} unit_fate;

// Joining, which cannot make a unit, fails where a unit is neither loaded nor missing.
static olx_result fate_of(olx_unit_store *s, const olx_unit_name *name, olx_result got, unit_fate *fate) {
  *fate = UNIT_LOADED;
  if (got == OLX_ERROR_INCOMPLETE) *fate = UNIT_MISSING;
  else if (got == OLX_ERROR_CHECKSUM && !s->joins) *fate = UNIT_DAMAGED;
  else if (got == OLX_ERROR_FILE && !s->joins) *fate = UNIT_UNREADABLE;
  else if (got == OLX_ERROR_CHECKSUM)
    return olx_fail(got, "%s: remove that file, and call a part again", olx_last_error());
  else return got;
  if (*fate != UNIT_DAMAGED) return OLX_OK;
  olx_log(OLX_LOG_WARNING, "%s; it is made again", olx_last_error());
  olx_work_folder_drop(s->folder, name);
  return OLX_OK;
}

static olx_result load_unit(olx_unit_store *s, const olx_unit_stage *stage, uint32_t unit, unit_fate *fate) {
  const double start = olx_seconds();
  const olx_unit_name name = name_of(stage, unit);
  void *data;
  size_t size_bytes;
  OLX_TRY(olx_check_cancelled());
  const olx_result got = olx_work_folder_get(s->folder, &name, &data, &size_bytes);
  OLX_TRY(fate_of(s, &name, got, fate));
  if (*fate != UNIT_LOADED) return OLX_OK;
  const olx_result result = load_bytes(stage, unit, data, size_bytes);
  olx_release(data);
  if (result == OLX_OK) report(s, stage, unit, "", start, size_bytes);
  return result;
}

static olx_result refuse_more(olx_unit_store *s) {
  const unsigned long long limit = (unsigned long long)s->settings.limit_bytes;
  if (s->settings.parts) {
    return olx_fail(OLX_ERROR_FILE, "%s: more than the %llu bytes that the work folder may take", s->path, limit);
  }
  s->full = true;
  olx_log(OLX_LOG_WARNING, "%s: holds the %llu bytes that it may; what is made from now on is not kept", s->path,
          limit);
  return OLX_OK;
}

// Goes on without storing results, which a whole bake can do without, where the disk has no space for them.
static olx_result go_on_unstored(olx_unit_store *s) {
  s->full = true;
  olx_log(OLX_LOG_WARNING, "%s; what is made from now on is not kept", olx_last_error());
  return OLX_OK;
}

static olx_result store_bytes(olx_unit_store *s, const olx_unit_name *name, const olx_byte_writer *bytes) {
  if (bytes->failed) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for a result", s->path);
  const uint64_t limit = s->settings.limit_bytes;
  if (limit && olx_work_folder_bytes(s->folder) + OLX_UNIT_HEADER_BYTES + bytes->size_bytes > limit)
    return refuse_more(s);
  const olx_result result = olx_work_folder_put(s->folder, name, bytes->data, bytes->size_bytes);
  const bool goes_on = result != OLX_OK && olx_work_folder_is_full(s->folder) && !s->settings.parts;
  return goes_on ? go_on_unstored(s) : result;
}

static olx_result store_unit(olx_unit_store *s, const olx_unit_stage *stage, uint32_t unit, uint64_t *size_bytes) {
  olx_byte_writer bytes = {0};
  *size_bytes = 0;
  if (s->full) return OLX_OK;
  stage->save(stage->user, unit, &bytes);
  const olx_unit_name name = name_of(stage, unit);
  const olx_result result = store_bytes(s, &name, &bytes);
  *size_bytes = s->full ? 0 : bytes.size_bytes;
  olx_byte_writer_free(&bytes);
  return result;
}

olx_result olx_unit_keep(olx_unit_store *s, const olx_unit_stage *stage) {
  uint64_t bytes;
  return s ? store_unit(s, stage, 0, &bytes) : OLX_OK;
}

// Makes a unit that was not loaded.
static olx_result make_unit(olx_unit_store *s, const olx_unit_stage *stage, uint32_t unit, unit_fate fate) {
  const double start = olx_seconds();
  uint64_t bytes;
  if (!s) return stage->make(stage->user, unit);
  const olx_unit_name name = name_of(stage, unit);
  olx_manifest_value why = {"damaged"};
  if (fate == UNIT_UNREADABLE) why = (olx_manifest_value){"unreadable"};
  if (fate == UNIT_MISSING) why = reason_for(s, &name);
  if (fate == UNIT_UNREADABLE) olx_log(OLX_LOG_WARNING, "%s; its unit is made again", olx_last_error());
  OLX_TRY(stage->make(stage->user, unit));
  OLX_TRY(store_unit(s, stage, unit, &bytes));
  report(s, stage, unit, why.text, start, bytes);
  return OLX_OK;
}

static olx_result refuse_missing(olx_unit_store *s, const olx_unit_stage *stage, uint32_t missing) {
  s->awaited = (awaited_units){.round = stage->round, .count = stage->count, .parts = stage->parts};
  snprintf(s->awaited.stage, sizeof s->awaited.stage, "%s", stage->name);
  return olx_fail(OLX_ERROR_INCOMPLETE, "%s: %u of %u units of the stage '%s' are not there yet", s->path, missing,
                  stage->count, stage->name);
}

// A stage whose units are looked for in a store.
typedef struct stage_place {
  const olx_unit_store *store;
  const olx_unit_stage *stage;
} stage_place;

static bool has_unit(const void *user, uint32_t unit) {
  const stage_place *place = user;
  const olx_unit_name name = name_of(place->stage, unit);
  return is_stored(place->store, &name);
}

static uint32_t count_missing(const olx_unit_store *s, const olx_unit_stage *stage) {
  const stage_place place = {s, stage};
  uint32_t missing = 0;
  for (uint32_t unit = 0; unit < stage->count; unit++) missing += !has_unit(&place, unit);
  return missing;
}

// Other parts may store units while this one looks for them.
static olx_result refuse_if_missing(olx_unit_store *s, const olx_unit_stage *stage) {
  const uint32_t missing = count_missing(s, stage);
  return missing > 0 ? refuse_missing(s, stage, missing) : OLX_OK;
}

static olx_result make_share(olx_unit_store *s, const olx_unit_stage *stage) {
  const stage_place place = {s, stage};
  olx_unit_deal deal = deal_of(s, stage);
  uint32_t next;
  while (olx_unit_deal_next(&deal, has_unit, &place, &next)) OLX_TRY(make_unit(s, stage, next, UNIT_MISSING));
  return refuse_if_missing(s, stage);
}

static olx_result make_all(olx_unit_store *s, const olx_unit_stage *stage) {
  for (uint32_t unit = 0; unit < stage->count; unit++) {
    const olx_unit_name name = name_of(stage, unit);
    unit_fate fate = UNIT_MISSING;
    if (is_stored(s, &name)) OLX_TRY(load_unit(s, stage, unit, &fate));
    if (fate == UNIT_LOADED) continue;
    if (olx_unit_store_joins(s)) return refuse_missing(s, stage, count_missing(s, stage));
    OLX_TRY(make_unit(s, stage, unit, fate));
  }
  return OLX_OK;
}

olx_result olx_units_make(olx_unit_store *s, const olx_unit_stage *stage) {
  return olx_unit_store_is_part(s) ? make_share(s, stage) : make_all(s, stage);
}

// Waits for a unit of another part. Returns whether it is stored.
static bool wait_for(const olx_unit_store *s, const olx_unit_name *name) {
  const double start = olx_seconds();
  bool stored = is_stored(s, name);
  while (!stored && s->settings.wait && olx_check_cancelled() == OLX_OK &&
         s->settings.wait(s->settings.user, olx_seconds() - start)) {
    stored = is_stored(s, name);
  }
  return stored;
}

olx_result olx_units_await(olx_unit_store *s, const olx_unit_stage *stage) {
  for (uint32_t unit = 0; s && unit < stage->count; unit++) {
    const olx_unit_name name = name_of(stage, unit);
    if (wait_for(s, &name)) continue;
    OLX_TRY(olx_check_cancelled());
    return refuse_if_missing(s, stage);
  }
  return OLX_OK;
}

olx_result olx_units_load(olx_unit_store *s, const olx_unit_stage *stage) {
  uint32_t absent = 0;
  for (uint32_t unit = 0; unit < stage->count; unit++) {
    unit_fate fate;
    OLX_TRY(load_unit(s, stage, unit, &fate));
    if (fate == UNIT_UNREADABLE) return OLX_ERROR_FILE;
    absent += fate != UNIT_LOADED;
  }
  return absent > 0 ? refuse_missing(s, stage, absent) : OLX_OK;
}

olx_result olx_unit_once(olx_unit_store *s, const olx_unit_stage *stage) {
  const olx_unit_name name = name_of(stage, 0);
  unit_fate fate = UNIT_MISSING;
  bool stored = is_stored(s, &name), mine = !olx_unit_store_joins(s);
  if (olx_unit_store_is_part(s)) {
    const olx_unit_deal deal = deal_of(s, stage);
    mine = olx_unit_is_dealt(&deal, 0);
  }
  if (!stored && !mine) {
    OLX_TRY(olx_units_await(s, stage));
    stored = true;
  }
  if (stored) OLX_TRY(load_unit(s, stage, 0, &fate));
  if (fate == UNIT_LOADED) return OLX_OK;
  if (mine) return make_unit(s, stage, 0, fate);
  return fate == UNIT_UNREADABLE ? OLX_ERROR_FILE : refuse_missing(s, stage, 1);
}

// ---- The mark of the stage for which parts wait

static void save_awaited(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  olx_bytes_put(to, user, 1, sizeof(awaited_units));
}

static bool is_stage_name(const char *name, size_t size) {
  const size_t length = strnlen(name, size);
  return length > 0 && length < size && strspn(name, "abcdefghijklmnopqrstuvwxyz") == length;
}

// A mark that cannot be true counts as none.
static olx_result load_awaited(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  awaited_units *a = user;
  olx_bytes_copy(from, a, 1, sizeof *a);
  if (!is_stage_name(a->stage, sizeof a->stage) || a->count > MOST_AWAITED) a->count = 0;
  return OLX_OK;
}

static olx_unit_stage mark_of(awaited_units *a) {
  return (olx_unit_stage){"awaited", 0, 1, a, NULL, save_awaited, load_awaited, OLX_PARTS_ALL};
}

static bool uses_marks(const olx_unit_store *s) { return olx_unit_store_is_part(s) && !s->settings.wait; }

olx_result olx_units_leave_mark(olx_unit_store *s) {
  if (!uses_marks(s) || s->awaited.count == 0) return OLX_OK;
  const olx_unit_stage mark = mark_of(&s->awaited);
  return olx_unit_keep(s, &mark);
}

// Refuses to go on where units of a stage are missing and this part has to compute none of them.
static olx_result refuse_units_of_others(olx_unit_store *s, const olx_unit_stage *stage) {
  const olx_unit_deal deal = deal_of(s, stage);
  uint32_t missing = 0;
  for (uint32_t unit = 0; unit < stage->count; unit++) {
    const olx_unit_name name = name_of(stage, unit);
    if (is_stored(s, &name)) continue;
    if (olx_unit_is_dealt(&deal, unit)) return OLX_OK;
    missing++;
  }
  return missing > 0 ? refuse_missing(s, stage, missing) : OLX_OK;
}

olx_result olx_units_heed_mark(olx_unit_store *s) {
  awaited_units awaited = {.count = 0};
  const olx_unit_stage mark = mark_of(&awaited);
  unit_fate fate;
  if (!uses_marks(s) || !olx_units_have(s, &mark)) return OLX_OK;
  OLX_TRY(load_unit(s, &mark, 0, &fate));
  const olx_unit_stage stage = {
      .name = awaited.stage, .round = awaited.round, .count = awaited.count, .parts = awaited.parts};
  return refuse_units_of_others(s, &stage);
}
