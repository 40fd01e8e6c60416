// Chooses the selector for a field.
#ifndef OLX_SELECT_SELECT_H
#define OLX_SELECT_SELECT_H

#include "field/field_data.h"

// Returns whether the field has the data that a selector needs.
bool olx_select_available(const olx_field *field, olx_select select);

// Resolves OLX_SELECT_BEST to the best selector of the field, and a selector that the field does not have to
// OLX_SELECT_EXHAUSTIVE.
olx_select olx_select_resolve(const olx_field *field, olx_select asked);

#endif
