// The tracers: each marches one piece of a ray through one probe's map, and all give the same answer.
#ifndef OLX_TRACE_MARCH_H
#define OLX_TRACE_MARCH_H

#include "trace/surfel.h"

// Visits every texel, without a pyramid: the reference.
olx_verdict olx_march_texels(olx_march *m, const olx_piece *p, olx_probe_answer *answer);

// Skips blocks whose smallest distance is beyond the ray (McGuire et al. 2017, section 4.1).
olx_verdict olx_march_two_level(olx_march *m, const olx_piece *p, olx_probe_answer *answer);


// Descends and ascends the whole pyramid (Wang 2018, section 4.3).
olx_verdict olx_march_hiz(olx_march *m, const olx_piece *p, olx_probe_answer *answer);

#endif
