// Parses JSON strictly and reads validated values from it: duplicate members, NULs in strings, and numbers that a float
// cannot hold are rejected.
#include "scene/import/json_value.h"

#include "core/hooks.h"
#include "core/result.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned line_of(const char *text, const char *end) {
  unsigned line = 1;
  for (const char *c = text; c < end; ++c) line += *c == '\n';
  return line;
}

// Rejects NULs, at which C strings end, both as bytes and as the escape \u0000.
static olx_result refuse_nul(const char *path, const char *text, size_t size_bytes) {
  bool inside = false;
  for (size_t i = 0; i < size_bytes; ++i) {
    if (text[i] == '"') inside = !inside;
    if (!inside) continue;
    const bool escape = text[i] == '\\';
    if (text[i] == 0 || (escape && size_bytes - i >= 6 && memcmp(text + i + 1, "u0000", 5) == 0)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: line %u: a NUL character inside a string", path, line_of(text, text + i));
    }
    if (escape) ++i;
  }
  return OLX_OK;
}

static int compare_names(const void *a, const void *b) {
  const cJSON *const *first = a, *const *second = b;
  return strcmp((*first)->string, (*second)->string);
}

// The path of an element, such as "nodes[3].mesh".
typedef struct json_place {
  char text[200];
} json_place;

static json_place place_below(const json_place *parent, const cJSON *item, uint32_t index) {
  json_place place;
  const char *dot = parent->text[0] ? "." : "";
  if (item->string) snprintf(place.text, sizeof place.text, "%.100s%s%.80s", parent->text, dot, item->string);
  else snprintf(place.text, sizeof place.text, "%.100s[%u]", parent->text, index);
  return place;
}

static olx_result refuse_twins(const char *path, const json_place *at, const cJSON *object, uint32_t count) {
  const cJSON **members = olx_allocate(count, sizeof *members), *member = NULL;
  if (!members) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  uint32_t i = 0;
  cJSON_ArrayForEach(member, object) members[i++] = member;
  qsort(members, count, sizeof *members, compare_names);
  olx_result result = OLX_OK;
  for (i = 1; i < count && result == OLX_OK; ++i) {
    if (strcmp(members[i - 1]->string, members[i]->string) != 0) continue;
    const json_place place = place_below(at, members[i], 0);
    result = olx_fail(OLX_ERROR_FORMAT, "%s: %s: there twice in one object", path, place.text);
  }
  olx_release(members);
  return result;
}

// The recursion is bounded, because cJSON limits the nesting of values.
static olx_result check_members(const char *path, const json_place *at, const cJSON *value) {
  const cJSON *item = NULL;
  uint32_t count = 0;
  cJSON_ArrayForEach(item, value) {
    const uint32_t index = count++;
    if (!item->child) continue;
    const json_place below = place_below(at, item, index);
    OLX_TRY(check_members(path, &below, item));
  }
  return cJSON_IsObject(value) && count > 1 ? refuse_twins(path, at, value, count) : OLX_OK;
}

olx_result olx_json_parse(const char *path, const char *text, size_t size_bytes, cJSON **root) {
  const char *end = text, *const limit = text + size_bytes;
  if (size_bytes == 0) return olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  OLX_TRY(refuse_nul(path, text, size_bytes));
  *root = cJSON_ParseWithLengthOpts(text, size_bytes, &end, false);
  if (!*root) return olx_fail(OLX_ERROR_FORMAT, "%s: not valid JSON near line %u", path, line_of(text, end));
  while (end < limit && (isspace((unsigned char)*end) || *end == 0)) ++end;
  const olx_result result = end == limit ? check_members(path, &(json_place){""}, *root)
                                         : olx_fail(OLX_ERROR_FORMAT, "%s: line %u: text after the end of the JSON",
                                                    path, line_of(text, end));
  if (result == OLX_OK) return OLX_OK;
  cJSON_Delete(*root);
  *root = NULL;
  return result;
}

const char *olx_json_text(const cJSON *object, const char *key) {
  const cJSON *item = olx_json_member(object, key);
  return cJSON_IsString(item) ? item->valuestring : "";
}

bool olx_json_index(const cJSON *item, uint32_t count, uint32_t *index, bool *valid) {
  *valid = true;
  if (!item) return false;
  const double number = cJSON_IsNumber(item) ? item->valuedouble : -1.0;
  *valid = number >= 0.0 && number < (double)count && number == floor(number);
  if (*valid) *index = (uint32_t)number;
  return *valid;
}

bool olx_json_size(const cJSON *object, const char *key, uint64_t otherwise, uint64_t *size) {
  const cJSON *item = olx_json_member(object, key);
  *size = otherwise;
  if (!item) return true;
  const double number = cJSON_IsNumber(item) ? item->valuedouble : -1.0;
  if (!(number >= 0.0 && number <= 0x1p48) || number != floor(number)) return false;
  *size = (uint64_t)number;
  return true;
}

bool olx_json_float(const cJSON *item, float *value) {
  if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= 3.4e38)) return false;
  *value = (float)item->valuedouble;
  return true;
}

bool olx_json_doubles(const cJSON *item, double *values, int count) {
  if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != count) return false;
  const cJSON *element = NULL;
  int i = 0;
  cJSON_ArrayForEach(element, item) {
    float rounded;
    if (!olx_json_float(element, &rounded)) return false;
    values[i++] = element->valuedouble;
  }
  return true;
}

bool olx_json_floats(const cJSON *item, float *values, int count) {
  if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != count) return false;
  const cJSON *element = NULL;
  int i = 0;
  cJSON_ArrayForEach(element, item) {
    if (!olx_json_float(element, &values[i++])) return false;
  }
  return true;
}
