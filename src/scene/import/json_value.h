// Helpers over cJSON.
#ifndef OLX_SCENE_JSON_VALUE_H
#define OLX_SCENE_JSON_VALUE_H

#include <octalux/base.h>

#include <cjson/cJSON.h>

// Parses `size_bytes` of JSON text, followed only by white space. Errors name the file and the line. A NUL inside a
// string, which would cut it off, and duplicate members, of which one would be ignored, are rejected. The caller frees
// *root with cJSON_Delete.
olx_result olx_json_parse(const char *path, const char *text, size_t size_bytes, cJSON **root);

// Returns a member of an object; NULL when there is none, or when `object` is not an object.
static inline const cJSON *olx_json_member(const cJSON *object, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(object, key);
}

// Returns the text of a member; "" when it is absent or not a string.
const char *olx_json_text(const cJSON *object, const char *key);

// Reads a member or element as an index below `count`. Returns false when it is absent; *valid is whether it is absent
// or in range.
bool olx_json_index(const cJSON *item, uint32_t count, uint32_t *index, bool *valid);

// Reads a member that counts bytes or elements, up to 2^48; `otherwise` when it is absent. Returns false when the
// member is not such a number.
bool olx_json_size(const cJSON *object, const char *key, uint64_t otherwise, uint64_t *size);

// Reads a finite number that a float can hold.
bool olx_json_float(const cJSON *item, float *value);

// Reads exactly `count` finite numbers, in double precision or as floats. Both reject numbers that a float cannot hold.
bool olx_json_doubles(const cJSON *item, double *values, int count);
bool olx_json_floats(const cJSON *item, float *values, int count);

#endif
