// Measures the errors of irradiance in free space: of the irradiance volume and of irradiance probes, against path
// tracing.
#ifndef OLX_RENDER_AUDIT_SPACE_H
#define OLX_RENDER_AUDIT_SPACE_H

#include "core/parallel.h"
#include "field/field_data.h"
#include "scene/scene_data.h"

#include <octalux/render.h>

// Evaluates settings->space_points points of the space that the viewer can reach, with six normals each.
olx_result olx_audit_space(const olx_scene *scene, const olx_field *field, const olx_audit_settings *settings,
                           olx_task *task, olx_audit *audit);

#endif
