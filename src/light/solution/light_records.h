// Irradiance records (Ward et al. 1988): the places between which light is interpolated. The first are the visible
// surfels. Where light varies too much between them, their cells are divided, and each part without a record gets one
// that gathers light by rays once the solution is complete. Records pass no light on.
#ifndef OLX_LIGHT_LIGHT_RECORDS_H
#define OLX_LIGHT_LIGHT_RECORDS_H

#include "light/solution/light_ranges.h"

// Divides the cells of records between which light varies. Returns in *any whether there are new records to light: none
// where they would take more than most_final_rays, or where there would be OLX_LIGHT_MOST_RECORDS times as many records
// as visible surfels.
olx_result olx_light_records_plan(olx_scene_light *light, uint32_t round, bool *any);
// The irradiance of the planned round's records.
extern const olx_light_ranges olx_record_ranges;
void olx_light_records_settle(olx_scene_light *light);
// Builds the lookup of all records.
olx_result olx_light_records_look_up(olx_scene_light *light);
void olx_light_records_free(olx_light_records *records);

#endif
