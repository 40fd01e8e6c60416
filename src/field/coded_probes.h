// How many light field probes the chunks of selectors can name.
#ifndef OLX_FIELD_CODED_PROBES_H
#define OLX_FIELD_CODED_PROBES_H

#include <octalux/base.h>

enum { OLX_MAX_CODED_PROBES = 65535 };

// Checks that a selector's chunk can name that many probes; `name` begins the message.
olx_result olx_coded_probes_check(uint32_t probe_count, const char *chunk, const char *name);

#endif
