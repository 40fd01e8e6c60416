// Small helpers over cJSON.
#ifndef OLX_SCENE_JSON_VALUE_H
#define OLX_SCENE_JSON_VALUE_H

#include <octalux/base.h>

#include <cjson/cJSON.h>

// Parse `size_bytes` of JSON text, with nothing but white space after it. Errors name the file and the line. A NUL inside a
// string, which would cut it off, and two members of one name, of which one would be ignored, are refused. The caller frees
// *root with cJSON_Delete.
olx_result olx_json_parse(const char *path, const char *text, size_t size_bytes, cJSON **root);

// Member or element as an index below `count`. False when it is absent; *valid tells whether it is absent or in range.
bool olx_json_index(const cJSON *item, uint32_t count, uint32_t *index, bool *valid);

// A finite number that a float can hold.
bool olx_json_float(const cJSON *item, float *value);

// Exactly `count` finite numbers, in double precision and in floats. Neither takes what a float cannot hold.
bool olx_json_doubles(const cJSON *item, double *values, int count);
bool olx_json_floats(const cJSON *item, float *values, int count);

#endif
