// Which selector answers for a field.
#ifndef OLX_SELECT_SELECT_H
#define OLX_SELECT_SELECT_H

#include "field/field_data.h"

// Whether the field holds what a selector needs.
bool olx_select_available(const olx_field *field, olx_select select);

// What OLX_SELECT_BEST stands for, and OLX_SELECT_EXHAUSTIVE for a selector that the field does not have.
olx_select olx_select_resolve(const olx_field *field, olx_select asked);

#endif
