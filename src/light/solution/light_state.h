// The state of a solution between steps, as bytes of a unit: everything except links and points.
#ifndef OLX_LIGHT_LIGHT_STATE_H
#define OLX_LIGHT_LIGHT_STATE_H

#include "light/solution/light_solution.h"

void olx_light_state_save(const olx_scene_light *light, olx_byte_writer *to);
// Loads a state, in place of the current one.
olx_result olx_light_state_load(olx_scene_light *light, olx_byte_reader *from);

void olx_cell_table_save(const olx_cell_table *table, olx_byte_writer *to);
// Loads a table, in place of the existing one.
void olx_cell_table_load(olx_cell_table *table, olx_byte_reader *from);

#endif
