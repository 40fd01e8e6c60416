// Checks the positions of probes when a field is opened, and that as many are flagged as buried as its description
// says.
#include "core/result.h"
#include "field/field_chunks.h"

olx_result olx_probe_positions_open(olx_field *field) {
  const olx_probes_info *probes = &field->info.probes;
  return olx_positions_check(field->probe_positions, probes->count, probes->has_grid ? &probes->grid : NULL,
                             "light field", field->name, OLX_ERROR_FORMAT);
}

olx_result olx_irradiance_positions_open(olx_field *field) {
  const olx_irradiance_info *probes = &field->info.irradiance;
  return olx_positions_check(field->irradiance_positions, probes->probe_count, &probes->grid, "irradiance", field->name,
                             OLX_ERROR_FORMAT);
}

static olx_result check_flags(const olx_field *field, const uint8_t *flags, uint32_t count, uint32_t buried,
                              const char *kind) {
  uint32_t found = 0;
  for (uint32_t i = 0; i < count; i++) found += flags[i] & OLX_PROBE_BURIED;
  if (found == buried) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: %u %s probes are flagged as buried where the description says %u", field->name,
                  found, kind, buried);
}

olx_result olx_probe_flags_open(olx_field *field) {
  return check_flags(field, field->probe_flags, field->info.probes.count, field->info.probes.buried, "light field");
}

olx_result olx_irradiance_flags_open(olx_field *field) {
  const olx_irradiance_info *probes = &field->info.irradiance;
  return check_flags(field, field->irradiance_flags, probes->probe_count, probes->buried, "irradiance");
}
