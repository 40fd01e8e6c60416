// The tracers: each marches one piece of a ray through one probe's map and gives the same answer.
#ifndef OLX_TRACE_MARCH_H
#define OLX_TRACE_MARCH_H

#include "trace/surfel.h"

// Every texel, with no pyramid: the referee.
olx_verdict olx_march_texels(olx_march *m, const olx_piece *p, olx_probe_answer *answer);

// McGuire et al. 2017, section 4.1: blocks whose smallest distance is beyond the ray are skipped.
olx_verdict olx_march_two_level(olx_march *m, const olx_piece *p, olx_probe_answer *answer);


// Wang 2018, section 4.3: down and up the whole pyramid.
olx_verdict olx_march_hiz(olx_march *m, const olx_piece *p, olx_probe_answer *answer);

#endif
