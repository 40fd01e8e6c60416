// Small helpers over cJSON.
#ifndef OLX_SCENE_JSON_VALUE_H
#define OLX_SCENE_JSON_VALUE_H

#include <octalux/base.h>

#include <cjson/cJSON.h>

// Parse `size_bytes` of JSON text, with nothing but white space after it. Errors name the file and the line. A NUL
// inside a string, which would cut it off, and two members of one name, of which one would be ignored, are refused. The
// caller frees *root with cJSON_Delete.
olx_result olx_json_parse(const char *path, const char *text, size_t size_bytes, cJSON **root);

// A member of an object; NULL when there is none, or no object.
static inline const cJSON *olx_json_member(const cJSON *object, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(object, key);
}

// A member's text; "" when it is absent or no text.
const char *olx_json_text(const cJSON *object, const char *key);

// Member or element as an index below `count`. False when it is absent; *valid says whether it is absent or in range.
bool olx_json_index(const cJSON *item, uint32_t count, uint32_t *index, bool *valid);

// A member that counts bytes or elements, up to 2^48; `otherwise` when it is absent. False when it is no such number.
bool olx_json_size(const cJSON *object, const char *key, uint64_t otherwise, uint64_t *size);

// A finite number that a float can hold.
bool olx_json_float(const cJSON *item, float *value);

// Exactly `count` finite numbers, in double precision and in floats. Neither takes what a float cannot hold.
bool olx_json_doubles(const cJSON *item, double *values, int count);
bool olx_json_floats(const cJSON *item, float *values, int count);

#endif
