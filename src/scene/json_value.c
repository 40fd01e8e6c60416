#include "scene/json_value.h"

#include "core/result.h"

#include <ctype.h>
#include <math.h>

static unsigned line_of(const char *text, const char *end) {
  unsigned line = 1;
  for (const char *c = text; c < end; ++c) line += *c == '\n';
  return line;
}

olx_result olx_json_parse(const char *path, const char *text, size_t size_bytes, cJSON **root) {
  const char *end = text, *const limit = text + size_bytes;
  if (size_bytes == 0) return olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  *root = cJSON_ParseWithLengthOpts(text, size_bytes, &end, false);
  if (!*root) return olx_fail(OLX_ERROR_FORMAT, "%s: not valid JSON near line %u", path, line_of(text, end));
  while (end < limit && (isspace((unsigned char)*end) || *end == 0)) ++end;
  if (end == limit) return OLX_OK;
  cJSON_Delete(*root);
  *root = NULL;
  return olx_fail(OLX_ERROR_FORMAT, "%s: line %u: text after the end of the JSON", path, line_of(text, end));
}

bool olx_json_index(const cJSON *item, uint32_t count, uint32_t *index, bool *valid) {
  *valid = true;
  if (!item) return false;
  const double number = cJSON_IsNumber(item) ? item->valuedouble : -1.0;
  *valid = number >= 0.0 && number < (double)count && number == floor(number);
  if (*valid) *index = (uint32_t)number;
  return *valid;
}

bool olx_json_float(const cJSON *item, float *value) {
  if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= 3.4e38)) return false;
  *value = (float)item->valuedouble;
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
